// SPDX-License-Identifier: Apache-2.0
// Parses each export according to its format, not by our readers, and maps a point with it.
#include "io/export/export_transform.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <sstream>

#include "io/cameras/camera_file.h"
#include "support/calibration_result.h"

namespace sextant {
namespace {

using testing::HasSubstr;

const Eigen::Vector3d kInLidar(3.0, -0.5, 0.25);

std::string Exported(const char* format, const ExportOptions& options = {}) {
  const Expected<std::string> text =
      ExportTransform(format, test::FullCalibrationResult(), options);
  EXPECT_TRUE(text) << text.error().message;
  return text.value_or("");
}

Eigen::Vector3d InCam() { return test::FullCalibrationResult().cam_from_lidar * kInLidar; }

std::vector<double> NumbersOf(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> numbers;
  for (double value = 0.0; in >> value;) numbers.push_back(value);
  return numbers;
}

// The first group of the first match.
std::string Find(const std::string& text, const std::string& pattern) {
  std::smatch match;
  EXPECT_TRUE(std::regex_search(text, match, std::regex(pattern))) << pattern << "\n" << text;
  return match.empty() ? std::string() : match[1].str();
}

// The pose of a child by translation and quaternion in tf's order x y z w.
Eigen::Isometry3d FromXyzQuaternion(const std::vector<double>& n) {
  EXPECT_EQ(n.size(), 7U);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (n.size() != 7) return pose;
  pose.linear() = Eigen::Quaterniond(n[6], n[3], n[4], n[5]).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(n[0], n[1], n[2]);
  return pose;
}

// tf's rule: a point of the child maps into the parent.
void ExpectMaps(const Eigen::Isometry3d& parent_from_child, bool lidar_is_parent,
                double tolerance = 1e-12) {
  const Eigen::Vector3d in_child = lidar_is_parent ? InCam() : kInLidar;
  const Eigen::Vector3d in_parent = lidar_is_parent ? kInLidar : InCam();
  EXPECT_LT((parent_from_child * in_child - in_parent).norm(), tolerance);
}

class Direction : public testing::TestWithParam<bool> {
 protected:
  ExportOptions options() const {
    return {
        .camera_frame = "cam0_optical", .lidar_frame = "velodyne", .lidar_is_parent = GetParam()};
  }
  std::string parent() const { return GetParam() ? "velodyne" : "cam0_optical"; }
  std::string child() const { return GetParam() ? "cam0_optical" : "velodyne"; }
  void ExpectSaysDirection(const std::string& text) const {
    EXPECT_THAT(text, HasSubstr(parent() + "_from_" + child()));
    EXPECT_THAT(text, HasSubstr("point_in_" + parent() + " = "));
  }
};

TEST_P(Direction, Ros1) {
  const std::string text = Exported("ros1", options());
  const std::string args = Find(text, "args=\"([^\"]*)\"");
  ExpectMaps(FromXyzQuaternion(NumbersOf(args)), GetParam());
  EXPECT_TRUE(args.ends_with(" " + parent() + " " + child())) << args;
  ExpectSaysDirection(text);
  EXPECT_THAT(text, HasSubstr("pkg=\"tf2_ros\" type=\"static_transform_publisher\""));
}

// The values by option, in any order.
std::map<std::string, std::string> OptionsOf(const std::string& text) {
  std::map<std::string, std::string> values;
  const std::regex option("--([a-z-]+)'?,? '?([^ ',\"]+)");
  for (std::sregex_iterator it(text.begin(), text.end(), option), end; it != end; ++it) {
    values[(*it)[1]] = (*it)[2];
  }
  return values;
}

TEST_P(Direction, Ros2) {
  for (const char* format : {"ros2", "ros2_yaml"}) {
    const std::string text = Exported(format, options());
    std::map<std::string, std::string> values = OptionsOf(text);
    std::vector<double> numbers;
    for (const char* key : {"x", "y", "z", "qx", "qy", "qz", "qw"}) {
      ASSERT_TRUE(values.contains(key)) << key << text;
      numbers.push_back(std::stod(values[key]));
    }
    ExpectMaps(FromXyzQuaternion(numbers), GetParam());
    EXPECT_EQ(values["frame-id"], parent());
    EXPECT_EQ(values["child-frame-id"], child());
    ExpectSaysDirection(text);
  }
}

TEST_P(Direction, TfYaml) {
  const std::string text = Exported("tf_yaml", options());
  std::vector<double> numbers;
  for (const char* map : {"translation", "rotation"}) {
    const std::string values = Find(text, std::string(map) + ": \\{(.*)\\}");
    for (const char* key : {"x", "y", "z", "w"}) {
      if (std::string(map) == "translation" && *key == 'w') continue;
      numbers.push_back(std::stod(Find(values, std::string(key) + ": ([^,]*)")));
    }
  }
  ExpectMaps(FromXyzQuaternion(numbers), GetParam());
  EXPECT_EQ(Find(text, "\n  frame_id: \"([^\"]*)"), parent());
  EXPECT_EQ(Find(text, "\nchild_frame_id: \"([^\"]*)"), child());
  ExpectSaysDirection(text);
}

TEST_P(Direction, Urdf) {
  const std::string text = Exported("urdf", options());
  const std::vector<double> xyz = NumbersOf(Find(text, "xyz=\"([^\"]*)"));
  const std::vector<double> rpy = NumbersOf(Find(text, "rpy=\"([^\"]*)"));
  ASSERT_EQ(xyz.size(), 3U);
  ASSERT_EQ(rpy.size(), 3U);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  // Angles about the fixed axes of the parent, roll first.
  pose.rotate(Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()));
  pose.rotate(Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()));
  pose.translation() = Eigen::Vector3d(xyz[0], xyz[1], xyz[2]);
  // Near a pitch of 90 degrees, roll and yaw have fewer significant digits.
  ExpectMaps(pose, GetParam(), 1e-10);
  EXPECT_EQ(Find(text, "parent link=\"([^\"]*)"), parent());
  EXPECT_EQ(Find(text, "child link=\"([^\"]*)"), child());
  ExpectSaysDirection(text);
}

INSTANTIATE_TEST_SUITE_P(Parents, Direction, testing::Bool(), [](const auto& lidar_is_parent) {
  return lidar_is_parent.param ? "Lidar" : "Camera";
});

TEST(ExportTransform, UrdfAtGimbalLock) {
  CalibrationResult result = test::FullCalibrationResult();
  Eigen::Matrix3d r;
  r << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  result.cam_from_lidar.rotation = Eigen::Quaterniond(r);
  const std::string text = *ExportTransform("urdf", result, {.lidar_is_parent = false});
  const std::vector<double> rpy = NumbersOf(Find(text, "rpy=\"([^\"]*)"));
  ASSERT_EQ(rpy.size(), 3U);
  const Eigen::Quaterniond back = Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX());
  EXPECT_LT((back.toRotationMatrix() - r).norm(), 1e-7);
}

TEST(ExportTransform, KittiProjectsAsItsDevkitDoes) {
  const std::string text = Exported("kitti");
  std::map<std::string, std::vector<double>> values;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    ASSERT_NE(line.find(':'), std::string::npos) << line;
    if (line[0] != '#')
      values[line.substr(0, line.find(':'))] = NumbersOf(line.substr(line.find(':') + 1));
  }
  using Rows34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  ASSERT_EQ(values["Tr_velo_to_cam"].size(), 12U);
  ASSERT_EQ(values["P2"].size(), 12U);
  ASSERT_EQ(values["R0_rect"].size(), 9U);
  const Eigen::Map<const Rows34> tr(values["Tr_velo_to_cam"].data());
  const Eigen::Map<const Rows34> p2(values["P2"].data());
  const Eigen::Vector3d in_cam = tr * kInLidar.homogeneous();
  EXPECT_LT((in_cam - InCam()).norm(), 1e-12);
  const Eigen::Vector2d pixel = (p2 * in_cam.homogeneous()).hnormalized();
  const Camera camera = *test::FullCalibrationResult().camera;
  EXPECT_NEAR(pixel.x(), camera.fx_px * InCam().x() / InCam().z() + camera.cx_px, 1e-9);
  EXPECT_NEAR(pixel.y(), camera.fy_px * InCam().y() / InCam().z() + camera.cy_px, 1e-9);
  EXPECT_THAT(text, HasSubstr("point_in_cam = Tr_velo_to_cam * point_in_lidar"));
  EXPECT_THAT(text, HasSubstr("for undistorted images"));
}

TEST(ExportTransform, PlainMatrix) {
  const std::string text = Exported("matrix");
  std::string rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line[0] != '#') rows += line + " ";
  }
  const std::vector<double> numbers = NumbersOf(rows);
  ASSERT_EQ(numbers.size(), 16U);
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(numbers.data());
  EXPECT_LT(((matrix * kInLidar.homogeneous()).head<3>() - InCam()).norm(), 1e-12);
  EXPECT_THAT(text, HasSubstr("# cam_from_lidar: point_in_cam = "));
}

TEST(ExportTransform, OpenCvMatrixIsWrittenByRows) {
  const std::string text = Exported("opencv");
  EXPECT_TRUE(text.starts_with("%YAML:1.0\n---\n"));
  std::string data = Find(text, "cam_from_lidar: !!opencv-matrix[^\\[]*\\[([^\\]]*)");
  std::replace(data.begin(), data.end(), ',', ' ');
  const std::vector<double> numbers = NumbersOf(data);
  ASSERT_EQ(numbers.size(), 16U);
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(numbers.data());
  EXPECT_LT(((matrix * kInLidar.homogeneous()).head<3>() - InCam()).norm(), 1e-12);
}

// A lens that a reader takes for another one is a wrong camera.
TEST(ExportTransform, OpenCvCameraReadsBackWithItsModel) {
  Camera camera{.width_px = 1280,
                .height_px = 720,
                .fx_px = 700.1,
                .fy_px = 699.9,
                .cx_px = 639.3,
                .cy_px = 358.7};
  const auto expect_back = [&camera] {
    CalibrationResult result = test::FullCalibrationResult();
    result.camera = camera;
    const Expected<std::string> text = ExportTransform("opencv", result, {});
    ASSERT_TRUE(text) << text.error().message;
    const Expected<Camera> again = ParseCamera(*text, "c.yaml");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->model, camera.model);
    EXPECT_EQ(again->fx_px, camera.fx_px);
    EXPECT_EQ(again->distortion, camera.distortion);
    EXPECT_EQ(again->xi, camera.xi);
    EXPECT_EQ(again->alpha, camera.alpha);
  };
  expect_back();
  camera.model = CameraModel::kBrownConrady;
  camera.distortion = {-0.17, 0.025, 1.9e-4, -1.8e-3, 3.1e-3};
  expect_back();
  camera.model = CameraModel::kEquidistant;
  camera.distortion = {-0.054, 0.04, -0.01, 0.003};
  expect_back();
  camera.model = CameraModel::kOmnidirectional;
  camera.xi = 1.3;
  expect_back();
  camera.model = CameraModel::kDoubleSphere;
  camera.distortion = {};
  camera.xi = -0.2;
  camera.alpha = 0.55;
  expect_back();
}

// A fisheye without coefficients is no pinhole either.
TEST(ExportTransform, KittiStatesThatItsImagesAreUndistorted) {
  CalibrationResult result = test::FullCalibrationResult();
  for (const CameraModel model : {CameraModel::kPinhole, CameraModel::kEquidistant}) {
    result.camera->model = model;
    result.camera->distortion = {};
    const Expected<std::string> text = ExportTransform("kitti", result, {});
    ASSERT_TRUE(text) << text.error().message;
    EXPECT_EQ(text->find("for undistorted images") != std::string::npos,
              model == CameraModel::kEquidistant);
  }
}

TEST(ExportTransform, RefusesWhatTheFormatCannotHold) {
  CalibrationResult result = test::FullCalibrationResult();
  const auto message = [&result](const char* format, const ExportOptions& options) {
    const Expected<std::string> text = ExportTransform(format, result, options);
    return text ? std::string("written") : text.error().message;
  };
  EXPECT_THAT(message("ros3", {}), HasSubstr("did you mean 'ros1'?"));
  EXPECT_THAT(message("ros1", {.camera_frame = "a b"}), HasSubstr("named 'a b': expected letters"));
  EXPECT_THAT(message("ros1", {.lidar_frame = "x\" y=\""}), HasSubstr("the LiDAR's frame"));
  EXPECT_THAT(message("urdf", {.lidar_frame = ""}), HasSubstr("the LiDAR's frame is named ''"));
  EXPECT_THAT(message("urdf", {.camera_frame = "a", .lidar_frame = "a"}), HasSubstr("both frames"));
  result.camera.reset();
  EXPECT_THAT(message("kitti", {}), HasSubstr("the result has no camera"));
  EXPECT_EQ(message("opencv", {}), "written");
}

TEST(ExportTransform, EveryListedFormatIsWritten) {
  for (const ExportFormat& format : ExportFormats()) EXPECT_FALSE(Exported(format.name).empty());
}

}  // namespace
}  // namespace sextant
