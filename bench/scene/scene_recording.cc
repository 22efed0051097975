// SPDX-License-Identifier: Apache-2.0
#include "bench/scene/scene_recording.h"

#include <fmt/core.h>

#include <cstdlib>
#include <optional>

#include "base/units.h"
#include "calibrate/session/session.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/cloud_file.h"
#include "io/images/image_codec.h"
#include "io/poses/pose_file.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

template <class T>
T OrExit(Expected<T> value) {
  if (value) return std::move(*value);
  fmt::print(stderr, "{}\n", value.error().message);
  std::exit(1);
}

Eigen::Vector3d DirectionOf(Random& random) {
  Eigen::Vector3d direction;
  for (int i = 0; i < 3; ++i) direction(i) = random.Normal();
  return direction.normalized();
}

}  // namespace

RawRecording ReadRecording(const std::string& name, const std::string& pose,
                           const std::string& camera, const std::string& images,
                           const std::string& clouds) {
  RawRecording recording{
      .name = name,
      .camera = OrExit(ReadCamera(camera)),
      .cam_from_lidar = OrExit(CamFromLidar(OrExit(ReadPoseFile(pose)), std::nullopt, pose)),
      .pairs = {}};
  const Session session =
      OrExit(SessionOfFiles(std::vector<std::string>{images}, std::vector<std::string>{clouds}));
  for (const FilePair& files : session.files.pairs) {
    const std::string bytes = OrExit(ReadTextFile(files.image));
    recording.pairs.push_back({.grey = OrExit(DecodeImage(bytes, DecodedColor::kGrey)),
                               .scan = OrExit(ReadCloud(files.cloud))});
  }
  return recording;
}

std::vector<ScenePair> ScenePairsOf(const RawRecording& recording) {
  std::vector<ScenePair> pairs;
  for (const RawPair& raw : recording.pairs) {
    pairs.push_back(
        OrExit(MakeScenePair(raw.grey, raw.scan, recording.camera, recording.cam_from_lidar)));
  }
  return pairs;
}

std::vector<ScenePair> SomeOf(const std::vector<ScenePair>& pairs, std::size_t count,
                              Random& random) {
  std::vector<int> chosen(std::min(count, pairs.size()));
  random.Sample(static_cast<int>(pairs.size()), chosen);
  std::vector<ScenePair> some;
  for (const int i : chosen) some.push_back(pairs[static_cast<std::size_t>(i)]);
  return some;
}

Rigid3d OffBy(const Rigid3d& pose, const PoseOffset& offset, Random& random) {
  Vector6d delta;
  delta.head<3>() = offset.rotation_deg * kRadPerDeg * DirectionOf(random);
  delta.tail<3>() = offset.translation_m * DirectionOf(random);
  return Perturb(pose, delta);
}

}  // namespace sextant
