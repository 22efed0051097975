// SPDX-License-Identifier: Apache-2.0
// scene_figures DATA ACFR_POSE DRAWS: the table of docs/check.md, from real pairs of known
// calibration. ACFR_POSE is the calibration by the board of the same recording.
// scripts/check-figures runs it.
#include <fmt/core.h>

#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/median.h"
#include "base/units.h"
#include "bench/scene/scene_recording.h"
#include "calibrate/scene/pose_check.h"

namespace sextant {
namespace {

constexpr CheckLimits kLimits = {.rotation_rad = 0.5 * kRadPerDeg, .translation_m = 0.08};

struct Recording {
  Rigid3d cam_from_lidar;
  std::vector<ScenePair> pairs;
};

Recording Read(const std::string& pose, const std::string& camera, const std::string& images,
               const std::string& clouds) {
  const RawRecording raw = ReadRecording({}, pose, camera, images, clouds);
  return {raw.cam_from_lidar, ScenePairsOf(raw)};
}

// One row: starts off by exactly `off`; how the check judges them, and where the fit ends.
void Row(const char* name, const Recording& recording, std::size_t pairs, const PoseOffset& off,
         int draws) {
  Random random(static_cast<std::uint64_t>(pairs) * 1000 + 7);
  std::array<int, 3> states{};
  std::vector<double> rotations;
  std::vector<double> translations;
  int near = 0;
  for (int draw = 0; draw < draws; ++draw) {
    const std::vector<ScenePair> some = SomeOf(recording.pairs, pairs, random);
    const Rigid3d start = OffBy(recording.cam_from_lidar, off, random);
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

int Main(const std::string& data, const std::string& acfr_pose, int draws) {
  const std::string kitti = data + "/field/kitti";
  const std::string acfr = data + "/acfr_vlp16";
  const Recording street =
      Read(kitti + "/gt.json", kitti + "/gt.json", kitti + "/img/*.png", kitti + "/pcd/*.pcd");
  fmt::print(
      "| recording | pairs | given pose off by | still valid | moved | cannot tell | median of "
      "the refined pose | within 0.25 deg, 60 mm |\n|:--|--:|:--|--:|--:|--:|:--|--:|\n");
  const char* name = "KITTI, 64 rings";
  for (const std::size_t pairs : {7U, 3U, 1U}) Row(name, street, pairs, {}, draws);
  Row(name, street, 7, {.rotation_deg = 0.5}, draws);
  Row(name, street, 7, {.translation_m = 0.08}, draws);
  for (const std::size_t pairs : {7U, 3U}) Row(name, street, pairs, {2.0, 0.1}, draws);
  const Recording hall =
      Read(acfr_pose, acfr + "/camera_info.yaml", acfr + "/images/*.png", acfr + "/full/*.pcd");
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
