// SPDX-License-Identifier: Apache-2.0
#include "io/cameras/camera_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/bad_text.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using test::BadText;

using ErrorCode::kParse;
constexpr ErrorCode kInvalid = ErrorCode::kInvalidInput;

TEST(CameraFile, ReadsRosCalibrationYaml) {
  const Expected<Camera> camera = ParseCamera(R"(
image_width: 640
image_height: 480
camera_name: left
camera_matrix:
  rows: 3
  cols: 3
  data: [600.5, 0, 320, 0, 601, 240, 0, 0, 1]
distortion_model: rational_polynomial
distortion_coefficients: {rows: 1, cols: 8, data: [.1, .2, .3, .4, .5, .6, .7, .8]}
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
)",
                                              "c.yaml");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->model, CameraModel::kBrownConrady);
  EXPECT_EQ(camera->width_px, 640);
  EXPECT_EQ(camera->fx_px, 600.5);
  EXPECT_EQ(camera->cy_px, 240.0);
  EXPECT_EQ(camera->distortion[7], 0.8);
}

TEST(CameraFile, ZeroOrNoDistortionIsAPinhole) {
  for (const char* d : {"", "D: []", "d: [0, 0, 0, 0, 0]", "distortion_model: plumb_bob"}) {
    const Expected<Camera> camera =
        ParseCamera(std::string("k: [600, 0, 320, 0, 600, 240, 0, 0, 1]\n") + d + "\n", "c.yaml");
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_EQ(camera->model, CameraModel::kPinhole);
  }
}

TEST(CameraFile, TakesTheCameraOfAProblemFile) {
  const Expected<Camera> camera = ParseCamera(R"(
sextant_problem: 1
camera:
  model: equidistant
  width_px: 640
  fx_px: 600.5
  fy_px: 601
  cx_px: 320
  cy_px: 240
  distortion: [0.1, 0, 0, 0]
pairs_3d3d: []
)",
                                              "session.yaml");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->model, CameraModel::kEquidistant);
  EXPECT_EQ(camera->width_px, 640);
  EXPECT_EQ(camera->fx_px, 600.5);
  EXPECT_EQ(camera->distortion[0], 0.1);
}

TEST(CameraFile, CameraInfoReadsBackToTheBit) {
  Camera camera{.width_px = 1280,
                .height_px = 720,
                .fx_px = 700.1,
                .fy_px = 699.9,
                .cx_px = 639.3,
                .cy_px = 358.7};
  const auto expect_round_trip = [&] {
    const Expected<Camera> again = ParseCamera(FormatCameraInfo(camera, "cam"), "c.yaml");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->model, camera.model);
    EXPECT_EQ(again->width_px, camera.width_px);
    EXPECT_EQ(again->height_px, camera.height_px);
    EXPECT_EQ(again->fx_px, camera.fx_px);
    EXPECT_EQ(again->fy_px, camera.fy_px);
    EXPECT_EQ(again->cx_px, camera.cx_px);
    EXPECT_EQ(again->cy_px, camera.cy_px);
    EXPECT_EQ(again->distortion, camera.distortion);
    EXPECT_EQ(again->skew_px, camera.skew_px);
    EXPECT_EQ(again->xi, camera.xi);
    EXPECT_EQ(again->alpha, camera.alpha);
  };
  expect_round_trip();
  camera.model = CameraModel::kBrownConrady;
  camera.distortion = {-0.17, 0.025, 1.9e-4, -1.8e-3, 3.1e-3};
  expect_round_trip();
  camera.distortion[7] = 1e-3;
  expect_round_trip();
  camera.distortion[9] = -2e-3;
  camera.distortion[13] = 0.01;
  camera.skew_px = 1.25;
  expect_round_trip();
  camera.skew_px = 0.0;
  camera.model = CameraModel::kEquidistant;
  camera.distortion = {-0.054, 0.04, -0.01, 0.003};
  expect_round_trip();
  camera.model = CameraModel::kOmnidirectional;
  camera.xi = 1.3;
  expect_round_trip();
  camera.model = CameraModel::kDoubleSphere;
  camera.distortion = {};
  camera.xi = -0.2;
  camera.alpha = 0.55;
  expect_round_trip();
}

class BadCameraTest : public testing::TestWithParam<BadText> {};

TEST_P(BadCameraTest, EndsInOneLineThatSaysWhereAndWhat) {
  ExpectRefused(ParseCamera(GetParam().text, "c"), GetParam());
}

const std::string kMatrix = "K: [600, 0, 320, 0, 600, 240, 0, 0, 1]\n";

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadCameraTest,
    testing::Values(
        BadText{"Empty", "", kParse, "c:1: the file is empty"},
        BadText{"NoCamera", "a: 1", kParse,
                "expected a camera: camera_matrix, K, fx, intrinsics or camera"},
        BadText{"TwoCameras", "cam0: {intrinsics: [1, 1, 1, 1]}\ncam1: {intrinsics: [1, 1, 1, 1]}",
                kParse, "the file holds 2 cameras: cam0, cam1; name one of them, as in c:cam0"},
        BadText{"KalibrCount", "cam0: {camera_model: omni, intrinsics: [1, 1, 1, 1]}", kParse,
                "expected 5 numbers for the camera model 'omni', got 4"},
        BadText{"Projection", "P2: 1 0 0 0", kParse, "expected 12 numbers, got 4"},
        BadText{"Xml", "<?xml version=\"1.0\"?>\n<opencv_storage><a>", kParse, "opencv_storage"},
        BadText{"BlockWithoutFocal", "sextant_problem: 1\ncamera:\n  model: pinhole\n", kParse,
                "fx_px"},
        BadText{"EightNumbers", "K: [1, 0, 1, 0, 1, 1, 0, 0]", kParse,
                "c:1: camera matrix: expected 9 numbers, got 8"},
        BadText{"Shear", "K: [600, 0, 320, 2, 600, 240, 0, 0, 1]", kInvalid, "fx skew cx"},
        BadText{"Singular", "K: [0, 0, 320, 0, 600, 240, 0, 0, 1]", kInvalid, "c: "},
        BadText{"NegativeFocal", "K: [-600, 0, 320, 0, 600, 240, 0, 0, 1]", kInvalid, "c: "},
        BadText{"Model", kMatrix + "distortion_model: panoramic", kInvalid, "got 'panoramic'"},
        BadText{"FisheyeCount", kMatrix + "distortion_model: fisheye\nD: [1, 2, 3, 4, 5]", kInvalid,
                "expected 4 distortion coefficients k1..k4 for the fisheye model, got 5"},
        BadText{"ThreeCoefficients", kMatrix + "D: [0.1, 0, 0]", kInvalid,
                "expected 4 to 14 distortion coefficients (of k1 k2 p1 p2 k3"},
        BadText{"SphereCount", kMatrix + "distortion_model: double_sphere\nxi: 0.1\nD: [0.1]",
                kInvalid, "xi and alpha alone"},
        BadText{"Millimetres",
                "image_width: 640\nimage_height: 480\n"
                "K: [4.2, 0, 3.2, 0, 4.2, 2.4, 0, 0, 1]",
                kInvalid,
                "the focal length is 4.2 px in an image 640 px wide? Intrinsics are in pixels"},
        BadText{"ColmapCount", "1 OPENCV 640 480 600 600 320\n", kParse, "12 values of the model"},
        BadText{"ColmapModel", "1 FOV 640 480 600 600 320 240 0.9\n", kInvalid, "got 'FOV'"},
        BadText{"ColmapTwo", "1 PINHOLE 9 9 60 60 4 4\n2 PINHOLE 9 9 60 60 4 4\n", kParse,
                "name one of them, as in c:2"},
        BadText{"LongList", kMatrix + "D: [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]", kParse,
                "expected at most 14 numbers, got 15"},
        BadText{"NotANumber", "K: [.nan, 0, 320, 0, 600, 240, 0, 0, 1]", ErrorCode::kNonFinite,
                "c:1: camera matrix"},
        BadText{"IniTruncated", "[camera]\ncamera matrix\n1 0 2\n0 1 2\n", kParse,
                "c:4: the file ends here, expected row 3 of 3 of the camera matrix"},
        BadText{"IniHeading", "[camera]\ncamera matrx\n", kParse,
                "c:2: unknown heading 'camera matrx'; did you mean 'camera matrix'?"},
        BadText{"IniWithoutMatrix", "[image]\nwidth\n640\n", kParse,
                "expected the heading camera matrix"},
        BadText{"IniComma", "[image]\nwidth\n640,5\n", kParse, "c:3: field 1 (width)"}),
    [](const auto& bad) { return bad.param.name; });

TEST(CameraFile, OneOfSeveralIsChosenByName) {
  const std::string text =
      "cam0: {camera_model: pinhole, intrinsics: [600, 601, 320, 240]}\n"
      "cam1: {camera_model: pinhole, intrinsics: [700, 701, 320, 240], resolution: [640, 480],\n"
      "  distortion_model: equidistant, distortion_coeffs: [0.1, 0.02, 0, 0]}\n";
  const Expected<Camera> camera = ParseNamedCamera(text, "chain.yaml", "cam1");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->fx_px, 700.0);
  EXPECT_EQ(camera->fy_px, 701.0);
  EXPECT_EQ(camera->height_px, 480);
  EXPECT_EQ(camera->model, CameraModel::kEquidistant);
  const Expected<Camera> absent = ParseNamedCamera(text, "chain.yaml", "cam2");
  ASSERT_FALSE(absent);
  EXPECT_THAT(absent.error().message, testing::HasSubstr("no camera 'cam2'; it has cam0, cam1"));
}

struct OtherForm {
  const char* name;
  const char* text;
  const char* camera;
};

// One camera as nuScenes, Waymo, COLMAP, Matlab, OpenCV's samples and others write it.
TEST(CameraFile, TheSameCameraInFormsOfOtherPrograms) {
  const OtherForm forms[] = {
      {"nuScenes", R"([{"token": "a", "camera_intrinsic": []},
          {"token": "b", "camera_intrinsic": [[600, 0, 320], [0, 601, 240], [0, 0, 1]],
           "camera_distortion": [-0.1, 0.02, 0.001, 0.002, 0]}])",
       ""},
      {"Waymo", "{name: FRONT, intrinsic: [600, 601, 320, 240, -0.1, 0.02, 0.001, 0.002, 0]}", ""},
      {"COLMAP",
       "# Camera list\n1 PINHOLE 9 9 50 50 4 4\n"
       "2 OPENCV 640 480 600 601 320.5 240.5 -0.1 0.02 0.001 0.002\n",
       "2"},
      {"Matlab",
       "IntrinsicMatrix = [600 0 0; 0 601 0; 321 241 1];\n% a comment = 1\n"
       "RadialDistortion = [-0.1 0.02];\nTangentialDistortion = [0.001 0.002];\n"
       "ImageSize = [480 640];\n",
       ""},
      {"Bouguet",
       "fc = [ 600.0 ; 601.0 ];\ncc = [ 320 ; 240 ];\nalpha_c = 0.0;\n"
       "kc = [ -0.1 ; 0.02 ; 0.001 ; 0.002 ; 0 ];\nnx = 640; ny = 480;\n",
       ""},
      {"Python",
       "K = np.array([[600, 0, 320],\n  [0, 601, 240], [0, 0, 1]])\nD = [-.1, .02, 1e-3, 2e-3]",
       ""},
      {"Numbers", "600 0 320\n0 601 240\n0 0 1\n-0.1 0.02 0.001 0.002 0\n", ""},
      {"Open3D",
       "{\"width\": 640, \"height\": 480, \"intrinsic_matrix\": [600, 0, 0, 0, 601, 0, 320, "
       "240, 1], \"D\": [-0.1, 0.02, 0.001, 0.002, 0]}",
       ""},
      {"Autoware",
       "%YAML:1.0\n---\nCameraMat: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
       "   data: [600, 0, 320, 0, 601, 240, 0, 0, 1]\nDistCoeff: !!opencv-matrix\n"
       "   rows: 1\n   cols: 5\n   dt: d\n   data: [-0.1, 0.02, 0.001, 0.002, 0]\n"
       "ImageSize: [640, 480]\n",
       ""},
      {"OpenCV stereo",
       "M1: {rows: 3, cols: 3, data: [600, 0, 320, 0, 601, 240, 0, 0, 1]}\n"
       "D1: {rows: 1, cols: 4, data: [-0.1, 0.02, 0.001, 0.002]}\n",
       ""},
      {"RealSense",
       "{width: 640, height: 480, ppx: 320, ppy: 240, fx: 600, fy: 601, "
       "coeffs: [-0.1, 0.02, 0.001, 0.002, 0]}",
       ""},
      {"byte order mark",
       "\xef\xbb\xbf"
       "K: [600, 0, 320, 0, 601, 240, 0, 0, 1]\n"
       "D: [-0.1, 0.02, 0.001, 0.002, 0]\n",
       ""}};
  for (const OtherForm& form : forms) {
    const Expected<Camera> camera = ParseNamedCamera(form.text, "c", form.camera);
    ASSERT_TRUE(camera) << form.name << ": " << camera.error().message;
    EXPECT_EQ(camera->model, CameraModel::kBrownConrady) << form.name;
    EXPECT_EQ(camera->fx_px, 600.0) << form.name;
    EXPECT_EQ(camera->fy_px, 601.0) << form.name;
    EXPECT_EQ(camera->cx_px, 320.0) << form.name;
    EXPECT_EQ(camera->cy_px, 240.0) << form.name;
    EXPECT_EQ(camera->distortion[0], -0.1) << form.name;
    EXPECT_EQ(camera->distortion[1], 0.02) << form.name;
    EXPECT_EQ(camera->distortion[2], 0.001) << form.name;
    EXPECT_EQ(camera->distortion[3], 0.002) << form.name;
    EXPECT_TRUE(camera->width_px == 640 || camera->width_px == 0) << form.name;
    EXPECT_EQ(camera->height_px == 480, camera->width_px == 640) << form.name;
  }
}

// As `rostopic echo` and `ros2 topic echo` print CameraInfo, which people redirect into a file.
TEST(CameraFile, MessagesAsTheyAreEchoed) {
  const std::string message =
      "header:\n  frame_id: cam\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\n"
      "d:\n- -0.1\n- 0.02\n- 0.0\n- 0.0\n- 0.0\nk:\n- 600.0\n- 0.0\n- 320.0\n- 0.0\n- 601.0\n"
      "- 240.0\n- 0.0\n- 0.0\n- 1.0\n---\n";
  for (const std::string& text :
       {message, message + message, "---\n" + message, "# made by: a program\n---\n" + message}) {
    const Expected<Camera> camera = ParseCamera(text, "info.yaml");
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_EQ(camera->fy_px, 601.0);
    EXPECT_EQ(camera->distortion[0], -0.1);
  }
  std::string other = message;
  other.replace(other.find("601.0"), 5, "555.0");
  const Expected<Camera> two = ParseCamera(message + other, "info.yaml");
  ASSERT_FALSE(two);
  EXPECT_THAT(two.error().message, testing::HasSubstr("expected one camera"));
}

TEST(CameraFile, DistortionUnderAnotherNameIsNotIgnored) {
  const Expected<Camera> camera = ParseCamera(
      "r3live_vio:\n  image_width: 640\n  camera_intrinsic: [600, 0, 320, 0, 601, 240, 0, 0, 1]\n"
      "  camera_dist_coeffs: [-0.1, 0.02, 0, 0, 0]\n",
      "r3live.yaml");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->distortion[0], -0.1);
}

// OpenCV's calibration sample writes the four coefficients of a fisheye under the usual key.
TEST(CameraFile, TheFlagOfAFisheyeIsItsModel) {
  const std::string text =
      "%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [600, 0, 320, 0, 601, 240, 0, 0, 1]\ndistortion_coefficients: !!opencv-matrix\n"
      "   rows: 4\n   cols: 1\n   dt: d\n   data: [-0.05, 0.04, -0.01, 0.003]\nfisheye_model: ";
  const Expected<Camera> fisheye = ParseCamera(text + "1\n", "c.yml");
  ASSERT_TRUE(fisheye) << fisheye.error().message;
  EXPECT_EQ(fisheye->model, CameraModel::kEquidistant);
  const Expected<Camera> usual = ParseCamera(text + "0\n", "c.yml");
  ASSERT_TRUE(usual) << usual.error().message;
  EXPECT_EQ(usual->model, CameraModel::kBrownConrady);
}

TEST(CameraFile, NoCoefficientUnderAKeyOfItsOwnIsIgnored) {
  const std::string text = "{fx: 600, fy: 601, cx: 320, cy: 240, k1: 0.2, k2: 0.02, k3: 0.01";
  const Expected<Camera> rational =
      ParseCamera(text + ", p1: 0.001, p2: 0.002, k4: 0.3, k5: 0.03, k6: 0.005}\n", "c.yaml");
  ASSERT_TRUE(rational) << rational.error().message;
  const std::vector<double> first(rational->distortion.begin(), rational->distortion.begin() + 8);
  EXPECT_EQ(first, (std::vector<double>{0.2, 0.02, 0.001, 0.002, 0.01, 0.3, 0.03, 0.005}));
  const Expected<Camera> unclear = ParseCamera(text + ", k4: 0.001}\n", "c.yaml");
  ASSERT_FALSE(unclear);
  EXPECT_THAT(unclear.error().message, testing::HasSubstr("distortion_model: equidistant"));
  const Expected<Camera> fisheye =
      ParseCamera(text + ", k4: 0.001, distortion_model: equidistant}\n", "c.yaml");
  ASSERT_TRUE(fisheye) << fisheye.error().message;
  EXPECT_EQ(fisheye->distortion[3], 0.001);
}

TEST(CameraFile, ReadsTheRealFilesOfEveryForm) {
  SEXTANT_REAL_DATA(path, ".");
  struct Row {
    const char* path;
    CameraModel model;
    int width_px;
    double fx_px;
    double cy_px;
    double first;
    double last;
  };
  const Row rows[] = {
      {"acfr_vlp16/camera_info.yaml", CameraModel::kEquidistant, 1920, 1176.93, 612.725, -0.0540096,
       -0.0515253},
      {"aruco_gold/tutorial_camera_charuco.yml", CameraModel::kBrownConrady, 640,
       4.5251072219637672e+02, 2.7775155919135995e+02, 1.2136925618707872e-01,
       2.9542589406810080e+00},
      {"aruco_gold/tutorial_camera_params.yml", CameraModel::kBrownConrady, 0, 628.158, 260.908,
       0.0995485, 0.0},
      {"ouster64/basler.yaml", CameraModel::kBrownConrady, 1920, 2813.643275, 624.049972, -0.134313,
       0.0},
      {"dhall/zed_left_uurmi.ini", CameraModel::kBrownConrady, 1280, 704.12, 393.9,
       -1.7716164842652732e-01, 3.0916019834707860e-03},
      {"dhall/ptgrey.ini", CameraModel::kBrownConrady, 1280, 2117.135189, 378.896917, -0.285236,
       0.0},
      {"dhall/geniusF100.ini", CameraModel::kBrownConrady, 640, 316.172746, 241.691715, 0.003758,
       0.0},
      {"field/cameras/camodocal_pinhole.yaml", CameraModel::kBrownConrady, 1280, 800.0, 360.0, -0.2,
       0.0},
      {"field/cameras/dkt_K_D_opencv.yml", CameraModel::kBrownConrady, 0, 998.3102608778569,
       525.8780909920658, -0.3701312603632176, -0.03852738839233336},
      {"field/cameras/fastcalib_ros2_params.yaml", CameraModel::kBrownConrady, 0,
       1794.9718035517628, 553.755812727975, -0.06285874342909396, 0.0},
      {"field/cameras/fastlivo_pinhole.yaml", CameraModel::kPinhole, 3840, 1106.460965921334,
       1920.0, 0.0, 0.0},
      {"field/cameras/ilcc2_pointgrey.yaml", CameraModel::kBrownConrady, 1920, 1061.37439737547,
       601.685030610243, -0.149007007770170, 0.0},
      {"field/cameras/jianbu_f_x.yaml", CameraModel::kBrownConrady, 0, 1031.01, 512.991, -0.334082,
       0.0},
      {"field/cameras/kalibr_camchain.yaml", CameraModel::kBrownConrady, 640, 343.848199580684,
       265.57285031082563, 0.005984652915192181, 0.0},
      {"field/cameras/kitti_calib.txt", CameraModel::kPinhole, 0, 718.856, 185.2157, 0.0, 0.0},
      {"field/cameras/livox_intrinsic.txt", CameraModel::kPinhole, 0, 908.524, 352.982, 0.0, 0.0},
      {"field/cameras/opencalib_intrinsic.json", CameraModel::kBrownConrady, 1920, 2117.31, 656.457,
       -0.102933, 0.429959},
      {"field/cameras/opencv.xml", CameraModel::kBrownConrady, 0, 800.0, 360.0, -0.2, 0.01},
      {"field/cameras/mei_camodocal.yaml", CameraModel::kOmnidirectional, 1280, 1300.0, 360.0, -0.1,
       0.0},
      {"field/cameras/omni.yaml", CameraModel::kOmnidirectional, 1280, 1300.1, 360.2, -0.22, 0.0},
      {"field/cameras/ost.txt", CameraModel::kBrownConrady, 1920, 1774.694944, 509.994361,
       -0.034137, 0.0},
      {"field/cameras/armando_fisheye.yaml", CameraModel::kEquidistant, 1920, 1025.060446336901,
       529.0830154465287, 0.048722742730037225, -0.11457851175852587},
  };
  for (const Row& row : rows) {
    const Expected<Camera> camera = ReadCamera(path / row.path);
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_EQ(camera->model, row.model) << row.path;
    EXPECT_EQ(camera->width_px, row.width_px) << row.path;
    EXPECT_EQ(camera->fx_px, row.fx_px) << row.path;
    EXPECT_EQ(camera->cy_px, row.cy_px) << row.path;
    EXPECT_EQ(camera->distortion[0], row.first) << row.path;
    const std::size_t last = row.model == CameraModel::kEquidistant ? 3 : 4;
    EXPECT_EQ(camera->distortion[last], row.last) << row.path;
  }
}

}  // namespace
}  // namespace sextant
