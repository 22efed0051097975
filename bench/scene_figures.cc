// SPDX-License-Identifier: Apache-2.0
// scene_figures DATA ACFR_POSE DRAWS: the table of docs/check.md, from real pairs of known
// calibration. ACFR_POSE is the calibration by the board of the same recording.
// scripts/check-figures runs it.
#include <fmt/core.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/median.h"
#include "base/random.h"
#include "base/units.h"
#include "calibrate/scene/pose_check.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/cloud_file.h"
#include "io/images/image_codec.h"
#include "io/poses/pose_file.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr CheckLimits kLimits = {.rotation_rad = 0.5 * kRadPerDeg, .translation_m = 0.08};

struct Recording {
  Rigid3d cam_from_lidar;
  std::vector<ScenePair> pairs;
};

template <class T>
T OrExit(Expected<T> value) {
  if (value) return std::move(*value);
  fmt::print(stderr, "scene_figures: {}\n", value.error().message);
  std::exit(1);
}

Recording Read(const fs::path& pose, const fs::path& camera_path, const fs::path& images,
               const fs::path& clouds) {
  Recording recording;
  const StatedPose stated = OrExit(ReadPoseFile(pose));
  recording.cam_from_lidar = OrExit(CamFromLidar(stated, std::nullopt, pose.string()));
  const Camera camera = OrExit(ReadCamera(camera_path));
  for (const auto& image : fs::directory_iterator(images)) {
    const fs::path cloud = clouds / image.path().filename().replace_extension(".pcd");
    const std::string bytes = OrExit(ReadTextFile(image.path()));
    recording.pairs.push_back(
        OrExit(MakeScenePair(OrExit(DecodeImage(bytes, DecodedColor::kGrey)),
                             OrExit(ReadCloud(cloud)), camera, recording.cam_from_lidar)));
  }
  return recording;
}

std::vector<ScenePair> Some(const Recording& recording, std::size_t count, Random& random) {
  std::vector<int> chosen(count);
  random.Sample(static_cast<int>(recording.pairs.size()), chosen);
  std::vector<ScenePair> some;
  for (const int i : chosen) some.push_back(recording.pairs[static_cast<std::size_t>(i)]);
  return some;
}

Eigen::Vector3d Direction(Random& random) {
  Eigen::Vector3d direction;
  for (int i = 0; i < 3; ++i) direction(i) = random.Normal();
  return direction.normalized();
}

struct Off {
  double rotation_deg = 0.0;
  double translation_m = 0.0;
};

Rigid3d Perturbed(const Rigid3d& pose, const Off& off, Random& random) {
  Vector6d delta;
  delta.head<3>() = off.rotation_deg * kRadPerDeg * Direction(random);
  delta.tail<3>() = off.translation_m * Direction(random);
  return Perturb(pose, delta);
}

// One row: starts off by exactly `off`; how the check judges them, and where the fit ends.
void Row(const char* name, const Recording& recording, std::size_t pairs, const Off& off,
         int draws) {
  Random random(static_cast<std::uint64_t>(pairs) * 1000 + 7);
  std::array<int, 3> states{};
  std::vector<double> rotations;
  std::vector<double> translations;
  int near = 0;
  for (int draw = 0; draw < draws; ++draw) {
    const std::vector<ScenePair> some = Some(recording, pairs, random);
    const Rigid3d start = Perturbed(recording.cam_from_lidar, off, random);
    const SceneFit fit = SearchScenes(some, start);
    ++states[static_cast<std::size_t>(CheckScenes(fit, start, kLimits).state)];
    const PoseDistance apart = DistanceBetween(fit.cam_from_lidar, recording.cam_from_lidar);
    rotations.push_back(apart.rotation_rad / kRadPerDeg);
    translations.push_back(1e3 * apart.translation_m);
    near += rotations.back() < 0.25 && translations.back() < 60.0;
  }
  fmt::print("| {} | {} | {:g} deg, {:g} mm | {} | {} | {} | {:.2f} deg, {:.0f} mm | {} of {} |\n",
             name, pairs, off.rotation_deg, 1e3 * off.translation_m, states[0], states[1],
             states[2], UpperMedian(rotations), UpperMedian(translations), near, draws);
}

int Main(const fs::path& data, const fs::path& acfr_pose, int draws) {
  const fs::path kitti = data / "field/kitti";
  const fs::path acfr = data / "acfr_vlp16";
  const Recording street = Read(kitti / "gt.json", kitti / "gt.json", kitti / "img", kitti / "pcd");
  fmt::print(
      "| recording | pairs | given pose off by | still valid | moved | cannot tell | median of "
      "the refined pose | within 0.25 deg, 60 mm |\n|:--|--:|:--|--:|--:|--:|:--|--:|\n");
  const char* name = "KITTI, 64 rings";
  for (const std::size_t pairs : {7U, 3U, 1U}) Row(name, street, pairs, {}, draws);
  Row(name, street, 7, {.rotation_deg = 0.5}, draws);
  Row(name, street, 7, {.translation_m = 0.08}, draws);
  for (const std::size_t pairs : {7U, 3U}) Row(name, street, pairs, {2.0, 0.1}, draws);
  const Recording hall = Read(acfr_pose, acfr / "camera_info.yaml", acfr / "images", acfr / "full");
  for (const double off : {0.0, 1.0})
    Row("one hall, 16 rings", hall, 5, {.rotation_deg = off}, draws);
  return 0;
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  return sextant::Main(argv[1], argv[2], std::atoi(argv[3]));
}
