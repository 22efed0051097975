// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "base/text/path_text.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/pose_argument.h"
#include "cli/progress.h"
#include "eval/metrics/cloud_fusion.h"
#include "io/clouds/cloud_file.h"
#include "io/clouds/pcd_file.h"
#include "io/clouds/ply_file.h"
#include "io/output/output_file.h"
#include "io/output/standard_output.h"
#include "io/problems/transform_list.h"
#include "io/results/rig_result.h"

namespace sextant::cli {
namespace {

struct FuseOptions {
  std::vector<std::string> clouds{};
  std::vector<std::string> from{};  ///< A file with cam_from_lidar for each cloud but the last.
  std::string to{};                 ///< The file for the last cloud.
  std::string pose_is{};
  std::string rts_path{};  ///< Replaces both.
  std::string rig_path{};  ///< Replaces both, with the sensor of each cloud.
  std::vector<std::string> sensors{};
  std::string out = "fused.ply";
  GivenOptions given{};
};

void Declare(FuseOptions& options, Arguments& arguments) {
  arguments.Add(
      "CLOUD", options.clouds,
      "Clouds, each in the frame of its own camera, or of its sensor of a rig: PCD, PLY,\n"
      "LAS, npy, KITTI .bin or a table (.csv, .xyz)",
      {.required = true});
  arguments.Add("--from", options.from,
                std::string("The pose of the camera of each cloud but the last: ") + kPoseHelp);
  arguments.Add("--to", options.to,
                "The pose of the camera of the last cloud, into whose frame all clouds go");
  DeclarePoseIs(options.pose_is, arguments);
  arguments.Add("--rts", options.rts_path,
                "Instead: rts.txt of the original package, one 4x4 matrix per cloud");
  arguments.Add("--result", options.rig_path, "Instead: rig.json of sextant rig, with --sensors");
  arguments.Add("--sensors", options.sensors,
                "The sensor of the rig that each cloud is of, by its name, in the order of clouds");
  arguments.Add("--out", options.out,
                "Cloud to write: .ply (each input cloud in its own colour) or .pcd",
                {.shows_default = true, .writes = Writes::kFile});
  arguments.ReportGiven(options.given);
}

// Distinguishable for the colour-blind too (Okabe and Ito 2008); the last cloud is grey.
constexpr std::array<PlyColor, 6> kColors = {
    {{230, 159, 0}, {86, 180, 233}, {0, 158, 115}, {240, 228, 66}, {213, 94, 0}, {204, 121, 167}}};
constexpr PlyColor kLastColor = {150, 150, 150};

/// The pose of each cloud's sensor, all from one frame.
struct CloudPoses {
  std::vector<Rigid3d> sensor_from_common;
  std::string caution;  ///< A line about a rig that is NOT USABLE; else empty.
};

Expected<CloudPoses> PosesOfRig(const FuseOptions& options) {
  SEXTANT_RETURN_IF_ERROR(RefuseGiven(options.given, {"--from", "--to", "--pose-is", "--rts"},
                                      "has no effect with --result and --sensors, which have the "
                                      "pose of every cloud"));
  if (options.rig_path.empty()) {
    return MakeError(ErrorCode::kInvalidOption, "--sensors needs --result, the rig.json of a rig");
  }
  SEXTANT_ASSIGN_OR_RETURN(const RigResult rig, RigOfFile(options.rig_path, "--result"));
  if (options.sensors.size() != options.clouds.size()) {
    std::string known;
    for (const RigResultSensor& sensor : rig.sensors) {
      known += (known.empty() ? "" : ", ") + sensor.name;
    }
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("--sensors: expected the sensor of each of the {} clouds, in their "
                    "order, got {}; there are: {}",
                    options.clouds.size(), options.sensors.size(), known));
  }
  CloudPoses poses;
  for (const std::string& sensor : options.sensors) {
    SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, rig.Between(sensor, rig.root));
    poses.sensor_from_common.push_back(pose);
  }
  if (!rig.refutations.empty()) {
    poses.caution = fmt::format("NOT USABLE: {}.\n\n", rig.refutations[0]);
  }
  return poses;
}

Expected<CloudPoses> PosesOf(const FuseOptions& options) {
  if (!options.rig_path.empty() || !options.sensors.empty()) return PosesOfRig(options);
  const std::size_t clouds = options.clouds.size();
  std::vector<Rigid3d> poses;
  if (!options.rts_path.empty()) {
    SEXTANT_RETURN_IF_ERROR(RefuseGiven(options.given, {"--from", "--to", "--pose-is"},
                                        "has no effect with --rts, which has the transform of "
                                        "every cloud"));
    SEXTANT_ASSIGN_OR_RETURN(const std::vector<Rigid3d> list, ReadTransformList(options.rts_path));
    poses = list;
  } else {
    std::vector<std::string> paths = options.from;
    if (!options.to.empty()) paths.push_back(options.to);
    for (const std::string& path : paths) {
      SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, PoseOfFile(path, options.pose_is));
      poses.push_back(pose);
    }
  }
  if (poses.size() == clouds && (options.rts_path.empty() ? !options.to.empty() : true)) {
    return CloudPoses{std::move(poses), {}};
  }
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("expected a transform for each of the {} clouds, in their order: "
                               "--from for each but the last and --to for that, --rts with all, or "
                               "--result rig.json with --sensors; got {}",
                               clouds, poses.size()));
}

std::string Merged(const FuseOptions& options, const std::vector<PointCloud>& clouds,
                   const PointCloud& fused) {
  if (options.out.ends_with(".pcd")) return FormatPcd(fused);
  std::vector<PlyColor> colors;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    const PlyColor color = i + 1 == clouds.size() ? kLastColor : kColors[i % kColors.size()];
    const auto finite =
        std::ranges::count_if(clouds[i].points, [](const auto& p) { return p.allFinite(); });
    colors.insert(colors.end(), static_cast<std::size_t>(finite), color);
  }
  return FormatPly(fused, colors);
}

std::string Describe(const FuseOptions& options, const std::vector<PointCloud>& clouds,
                     const std::vector<Rigid3d>& last_from_cloud, ProgressCounter& counter) {
  std::string text;
  const ReferenceCloud last(clouds.back());
  for (std::size_t i = 0; i + 1 < clouds.size(); ++i) {
    const CloudAgreement agreement = CompareClouds(clouds[i], last_from_cloud[i], last);
    counter.Step();
    text += fmt::format("{}: ", options.clouds[i]);
    text += agreement.compared == 0
                ? std::string("has no surface in common with the last cloud\n")
                : fmt::format(
                      "{:.0f} % of it is on surfaces of the last cloud, "
                      "{:.1f} mm off (median; rms {:.1f} mm)\n",
                      100.0 * agreement.Overlap(), 1e3 * agreement.median_m, 1e3 * agreement.rms_m);
  }
  return text;
}

int Run(const FuseOptions& options) {
  if (options.clouds.size() < 2) {
    return Refuse("fuse", {ErrorCode::kInvalidOption, "expected two clouds or more"});
  }
  if (!options.out.ends_with(".pcd") && !options.out.ends_with(".ply")) {
    return Refuse("fuse", {ErrorCode::kInvalidOption,
                           options.out + ": expected a name that ends in .ply or .pcd"});
  }
  const Expected<CloudPoses> poses = PosesOf(options);
  if (!poses) return Refuse("fuse", poses.error());
  const std::vector<Rigid3d>& sensors = poses->sensor_from_common;
  std::vector<PointCloud> clouds;
  std::vector<Rigid3d> last_from_cloud;
  Progress progress;
  // Each cloud is read, and each but the last one is compared with that.
  ProgressCounter counter(progress.Callback(), "fuse", 2 * options.clouds.size());
  for (std::size_t i = 0; i < options.clouds.size(); ++i) {
    Expected<PointCloud> cloud = ReadCloud(options.clouds[i]);
    if (!cloud) return Refuse("fuse", cloud.error());
    clouds.push_back(std::move(*cloud));
    counter.Step();
    last_from_cloud.push_back(sensors.back() * sensors[i].Inverse());
  }
  last_from_cloud.back() = Rigid3d{};  // Its points stay as they are, to the bit.
  const PointCloud fused = FuseClouds(clouds, last_from_cloud);
  if (const Expected<void> ok = WriteFileAtomically(options.out, Merged(options, clouds, fused));
      !ok) {
    return Refuse("fuse", ok.error());
  }
  const std::string text = Describe(options, clouds, last_from_cloud, counter);
  counter.Finish();
  Print("{}{}{}", poses->caution, text,
        WroteLine(options.out,
                  fmt::format("{} points of {} clouds in the frame of {}", fused.points.size(),
                              clouds.size(), PathText(options.clouds.back()))));
  return kAnswered;
}

}  // namespace

Command FuseCommand() {
  constexpr const char* kFooter =
      "The cameras need not see the same scene: the LiDAR connects them.\n"
      "last_from_cloud = T_last * inverse(T).\n"
      "Examples:\n"
      "  sextant fuse front.pcd side.pcd --from front.yaml --to side.yaml --out both.ply\n"
      "  sextant fuse cam1.pcd cam2.pcd --rts conf/rts.txt\n"
      "  sextant fuse rear.pcd top.pcd --result rig.json --sensors rear top";
  return MakeCommand<FuseOptions>("fuse", "Point clouds of calibrated sensors in one frame",
                                  kFooter, Declare, Run);
}

}  // namespace sextant::cli
