// SPDX-License-Identifier: Apache-2.0
// Poses checked and refined with everyday scenes: real pairs of known calibration, and the
// judgement.
#include "calibrate/scene/pose_check.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core/mat.hpp>

#include "base/random.h"
#include "base/units.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/cloud_file.h"
#include "io/images/image_codec.h"
#include "io/poses/pose_file.h"
#include "io/text/text_file.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr CheckLimits kLimits = {.rotation_rad = 0.5 * kRadPerDeg, .translation_m = 0.08};

struct Drive {
  Rigid3d cam_from_lidar;
  std::vector<ScenePair> pairs;
};

ScenePair PairOf(const std::filesystem::path& image, const std::filesystem::path& cloud,
                 const Camera& camera, const Rigid3d& pose) {
  const Expected<std::string> bytes = ReadTextFile(image);
  EXPECT_TRUE(bytes);
  const Expected<cv::Mat> grey = DecodeImage(*bytes, DecodedColor::kGrey);
  const Expected<PointCloud> scan = ReadCloud(cloud);
  EXPECT_TRUE(grey && scan);
  Expected<ScenePair> pair = MakeScenePair(*grey, *scan, camera, pose);
  EXPECT_TRUE(pair);
  return std::move(*pair);
}

const Drive& KittiDrive(const std::filesystem::path& folder) {
  static const Drive drive = [&] {
    const Expected<StatedPose> stated = ReadPoseFile(folder / "gt.json");
    EXPECT_TRUE(stated);
    Drive made{.cam_from_lidar = *CamFromLidar(*stated, std::nullopt, "gt.json"), .pairs = {}};
    const Expected<Camera> camera = ReadCamera(folder / "gt.json");
    EXPECT_TRUE(camera) << camera.error().message;
    for (const char* name :
         {"000000", "000649", "001297", "001946", "002595", "003244", "003892"}) {
      made.pairs.push_back(PairOf(folder / "img" / (std::string(name) + ".png"),
                                  folder / "pcd" / (std::string(name) + ".pcd"), *camera,
                                  made.cam_from_lidar));
    }
    return made;
  }();
  return drive;
}

// A pose off by so much about and along random axes.
Rigid3d OffBy(const Rigid3d& pose, double rotation_rad, double translation_m, Random& random) {
  Vector6d delta;
  for (int i = 0; i < 6; ++i) delta(i) = random.Normal();
  delta.head<3>() *= rotation_rad / delta.head<3>().norm();
  delta.tail<3>() *= translation_m / delta.tail<3>().norm();
  return Perturb(pose, delta);
}

TEST(PoseCheck, KittiIsStillValidAndMovedWhereItMoved) {
  SEXTANT_REAL_DATA(folder, "field/kitti");
  const Drive& drive = KittiDrive(folder);
  const auto state = [&](const Rigid3d& given) {
    const PoseCheck check = CheckScenes(SearchScenes(drive.pairs, given), given, kLimits);
    return fmt::format("{}: {}", ToString(check.state), check.reason);
  };
  EXPECT_THAT(state(drive.cam_from_lidar), HasSubstr("still valid"));
  Random random(3);
  EXPECT_THAT(state(OffBy(drive.cam_from_lidar, 0.5 * kRadPerDeg, 0.0, random)),
              HasSubstr("moved"));
}

// A clear fit at the given pose.
SceneFit ClearFit() {
  SceneFit fit;
  fit.own_covariance = 1e-6 * Matrix6d::Identity();
  fit.covariance = fit.own_covariance;
  fit.score = 100.0;
  fit.start_score = 100.0;
  fit.chance_sigma = 1.0;
  fit.held_out = 20.0;
  fit.focal_px = 700.0;
  fit.edges = 1000;
  fit.scenes = 7;
  fit.tiles = 60;
  fit.free_covariance = 1e-6 * Matrix9d::Identity();
  return fit;
}

TEST(PoseCheck, HalvesThatDoNotConfirmEachOtherTellNothing) {
  SceneFit fit = ClearFit();
  EXPECT_EQ(CheckScenes(fit, Rigid3d{}, kLimits).state, PoseState::kValid);
  fit.held_out = 2.0;
  fit.cam_from_lidar.translation.x() = 0.09;
  const PoseCheck check = CheckScenes(fit, Rigid3d{}, kLimits);
  EXPECT_EQ(check.state, PoseState::kUnknown);
  EXPECT_THAT(check.reason, HasSubstr("the halves of the scenes do not confirm each other"));
}

TEST(PoseCheck, ASmallChangeThatIsCertainIsStatedButValid) {
  SceneFit fit = ClearFit();
  fit.cam_from_lidar.translation.x() = 0.03;
  const PoseCheck small = CheckScenes(fit, Rigid3d{}, kLimits);
  EXPECT_EQ(small.state, PoseState::kValid);
  EXPECT_TRUE(small.is_certain);
  EXPECT_THAT(small.reason, HasSubstr("it has changed by"));
  EXPECT_THAT(small.reason, HasSubstr("30 +- 1 mm along x, which is certain"));
  // What may be as large as --detect has moved.
  fit.cam_from_lidar.translation.x() = 0.079;
  EXPECT_EQ(CheckScenes(fit, Rigid3d{}, kLimits).state, PoseState::kMoved);
}

TEST(PoseCheck, WrongIntrinsicsAreNamedInsteadOfAMotion) {
  SceneFit fit = ClearFit();
  fit.cam_from_lidar.translation.z() = 0.09;
  fit.free.intrinsics = {0.0296, 0.0, 0.01};
  const PoseCheck check = CheckScenes(fit, Rigid3d{}, kLimits);
  EXPECT_EQ(check.state, PoseState::kUnknown);
  EXPECT_THAT(check.reason, HasSubstr("focal length +3.0 +- 0.1 %"));
  EXPECT_THAT(check.reason, HasSubstr("7 +- 1 px down"));
  EXPECT_THAT(check.reason, HasSubstr("with better ones the pose may be the given one"));
}

TEST(PoseCheck, AFitAtTheLimitOfTheSearchStatesNoSigma) {
  SceneFit fit = ClearFit();
  fit.cam_from_lidar.translation = {0.0, 0.0, -0.102};
  fit.covariance = 1e-4 * Matrix6d::Identity();
  const PoseCheck far = CheckScenes(fit, Rigid3d{}, kLimits);
  EXPECT_EQ(far.state, PoseState::kMoved);
  EXPECT_THAT(far.reason, HasSubstr("by more than 0.1 m or 2 deg, the limit of the search"));
  EXPECT_THAT(far.reason, Not(HasSubstr("+-")));
  EXPECT_TRUE(std::isinf(far.covariance(5, 5)));
  // Within the limit the sigma is that of refine-scene, with the other optima.
  fit.cam_from_lidar.translation.z() = -0.05;
  const PoseCheck near = CheckScenes(fit, Rigid3d{}, kLimits);
  EXPECT_EQ(near.state, PoseState::kMoved);
  EXPECT_THAT(near.reason, HasSubstr("-50 +- 10 mm along z"));
  EXPECT_EQ(near.covariance, fit.covariance);
}

TEST(PoseCheck, KittiOffByAMetreIsNeverGivenASmallSigma) {
  SEXTANT_REAL_DATA(folder, "field/kitti");
  const Drive& drive = KittiDrive(folder);
  for (const int axis : {0, 2}) {
    Rigid3d given = drive.cam_from_lidar;
    given.translation(axis) += 1.0;
    const PoseCheck check = CheckScenes(SearchScenes(drive.pairs, given), given, kLimits);
    EXPECT_NE(check.state, PoseState::kValid) << check.reason;
    if (check.state != PoseState::kMoved) continue;
    EXPECT_THAT(check.reason, HasSubstr("the limit"));
  }
}

TEST(PoseCheck, KittiIsRefinedFromTwoDegreesAndTenCentimetres) {
  SEXTANT_REAL_DATA(folder, "field/kitti");
  const Drive& drive = KittiDrive(folder);
  Random random(5);
  const Rigid3d start = OffBy(drive.cam_from_lidar, 2.0 * kRadPerDeg, 0.1, random);
  const SceneFit fit = SearchScenes(drive.pairs, start);
  const PoseDistance off = DistanceBetween(fit.cam_from_lidar, drive.cam_from_lidar);
  EXPECT_LT(off.rotation_rad, 0.25 * kRadPerDeg);
  EXPECT_LT(off.translation_m, 0.06);
}

TEST(PoseCheck, KittiWithAWrongFocalLengthIsNotMoved) {
  SEXTANT_REAL_DATA(folder, "field/kitti");
  Drive drive = KittiDrive(folder);
  for (ScenePair& pair : drive.pairs) {
    pair.camera.fx_px *= 1.03;
    pair.camera.fy_px *= 1.03;
  }
  const PoseCheck check =
      CheckScenes(SearchScenes(drive.pairs, drive.cam_from_lidar), drive.cam_from_lidar, kLimits);
  EXPECT_EQ(check.state, PoseState::kUnknown);
  EXPECT_THAT(check.reason, HasSubstr("intrinsics do not suit the images (focal length -"));
}

TEST(PoseCheck, KittiWithScansOfOtherMomentsTellsNothing) {
  SEXTANT_REAL_DATA(folder, "field/kitti");
  Drive drive = KittiDrive(folder);
  for (std::size_t i = 0; i + 1 < drive.pairs.size(); ++i) {
    std::swap(drive.pairs[i].edges, drive.pairs[i + 1].edges);
  }
  const PoseCheck check =
      CheckScenes(SearchScenes(drive.pairs, drive.cam_from_lidar), drive.cam_from_lidar, kLimits);
  EXPECT_EQ(check.state, PoseState::kUnknown) << check.reason;
}

TEST(PoseCheck, JudgesAChangeByItsCovarianceAndTheLimits) {
  Matrix6d covariance = Matrix6d::Identity();
  covariance.topLeftCorner<3, 3>() *= 1e-6;
  covariance.bottomRightCorner<3, 3>() *= 1e-4;
  Vector6d change = Vector6d::Zero();
  EXPECT_EQ(JudgeChange(change, covariance, kLimits, 7, "scenes").state, PoseState::kValid);
  change(1) = 0.9 * kRadPerDeg;
  change(3) = 0.031;
  const PoseCheck moved = JudgeChange(change, covariance, kLimits, 7, "scenes");
  EXPECT_EQ(moved.state, PoseState::kMoved);
  EXPECT_THAT(moved.reason,
              HasSubstr("0.90 +- 0.06 deg about the camera's y, 31 +- 10 mm along x"));
  change.setZero();
  const PoseCheck unknown = JudgeChange(change, 36.0 * covariance, kLimits, 2, "scenes");
  EXPECT_EQ(unknown.state, PoseState::kUnknown);
  EXPECT_THAT(unknown.reason, HasSubstr("more scenes are needed"));
}

TEST(PoseCheck, AnEmptySceneTellsNothing) {
  const cv::Mat grey(240, 320, CV_8U, cv::Scalar(128));
  PointCloud scan;
  for (int ring = 0; ring < 8; ++ring) {
    for (int i = 0; i < 400; ++i) {
      const double azimuth = (i - 200) * 0.003;
      const double elevation = (ring - 4) * 0.03;
      scan.points.emplace_back(5.0, 5.0 * std::tan(azimuth), 5.0 * std::tan(elevation));
      scan.ring.push_back(static_cast<std::uint16_t>(ring));
    }
  }
  const Camera camera{.fx_px = 300.0, .fy_px = 300.0, .cx_px = 160.0, .cy_px = 120.0};
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Rigid3d pose{Eigen::Quaterniond(axes), Eigen::Vector3d::Zero()};
  const Expected<ScenePair> pair = MakeScenePair(grey, scan, camera, pose);
  ASSERT_TRUE(pair) << pair.error().message;
  const std::vector<ScenePair> pairs = {*pair};
  const PoseCheck check = CheckScenes(SearchScenes(pairs, pose), pose, kLimits);
  EXPECT_EQ(check.state, PoseState::kUnknown);
  EXPECT_THAT(check.reason, HasSubstr("too little structure: 0 depth edges"));

  Camera other = camera;
  other.fx_px = 80000.0;
  other.fy_px = 80000.0;
  const Expected<ScenePair> narrow = MakeScenePair(grey, scan, other, pose);
  ASSERT_FALSE(narrow);
  EXPECT_THAT(narrow.error().message, HasSubstr("an image of 320 x 240 pixels shows too little"));
}

}  // namespace
}  // namespace sextant
