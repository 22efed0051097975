// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/truth_yaml.h"

#include "base/text/escape.h"
#include "io/blocks/camera_block.h"
#include "io/text/yaml_text.h"
#include "simulator/scene/camera_model.h"

namespace sextant {
namespace {

// The value of each corner, as one YAML list.
template <class Value>
std::string ListOf(const std::vector<CornerTruth>& corners, Value value) {
  std::string list;
  for (const CornerTruth& corner : corners) list += (list.empty() ? "" : ", ") + value(corner);
  return "[" + list + "]";
}

void WriteCorners(YamlText& out, const std::string& indent, const Scene& scene,
                  const std::vector<CornerTruth>& corners) {
  out.Line("{}corners_in_world_m: {}", indent,
           ListOf(corners, [](const CornerTruth& c) { return YamlList(c.in_world); }));
  out.Line("{}corners_in_lidar_m: {}", indent,
           ListOf(corners, [](const CornerTruth& c) { return YamlList(c.in_lidar); }));
  out.Line("{}cameras:", indent);
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    out.Line("{}  - camera: {}", indent, scene.cameras[i].name);
    out.Line("{}    corners_in_cam_m: {}", indent,
             ListOf(corners, [i](const CornerTruth& c) { return YamlList(c.in_cam[i]); }));
    out.Line("{}    corners_px: {}", indent, ListOf(corners, [i](const CornerTruth& c) {
               return c.pixel[i] ? YamlList(*c.pixel[i]) : std::string("null");
             }));
  }
}

void WriteBoard(YamlText& out, const Scene& scene, const BoardTruth& board) {
  out.Line("      - id: {}", board.id);
  out.Line("        world_from_board: {}", YamlPose(board.world_from_board));
  WriteCorners(out, "        ", scene, board.corners);
  if (!board.tags.empty()) out.Line("        tags:");
  for (const TagTruth& tag : board.tags) {
    out.Line("          - family: {}", YamlQuoted(tag.family));
    out.Line("            id: {}", tag.id);
    WriteCorners(out, "            ", scene, tag.corners);
  }
}

void WriteScan(YamlText& out, const Scene& scene, const ScanTruth& scan) {
  out.Line("  - index: {}", scan.index);
  out.Line("    start_time_s: {}", scan.start_time_s);
  out.Line("    image_time_s: {}", scan.image_time_s);
  if (!scan.scan_file.empty()) out.Line("    scan: {}", scan.scan_file);
  out.Line("    cameras:");
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    out.Line("      - camera: {}", scene.cameras[i].name);
    if (!scan.image_files.empty()) out.Line("        image: {}", scan.image_files[i]);
    out.Line("        noise_seed: {}", scan.image_seeds[i]);
  }
  out.Line("    boards:");
  for (const BoardTruth& board : scan.boards) WriteBoard(out, scene, board);
}

}  // namespace

std::string FormatTruth(const Scene& scene, std::uint64_t seed,
                        const std::vector<ScanTruth>& scans) {
  YamlText out;
  out.Line("sextant_truth: 1");
  out.Line("scene: {}", YamlQuoted(scene.name));
  out.Line("seed: {}", seed);
  out.Line("lidar:");
  out.Line("  model: {}", scene.lidar.model);
  out.Line("  world_from_lidar: {}", YamlPose(scene.lidar.world_from_lidar));
  out.Line("cameras:");
  for (const SceneCamera& camera : scene.cameras) {
    out.Line("  - camera: {}", camera.name);
    out.Line("    world_from_cam: {}", YamlPose(camera.world_from_cam));
    out.Line("    cam_from_lidar: {}", YamlPose(CamFromLidar(scene, camera)));
    out.Line("    intrinsics:");
    WriteCameraKeys(out, "      ", *RenderingCamera(camera));
  }
  out.Line("scans:");
  for (const ScanTruth& scan : scans) WriteScan(out, scene, scan);
  return out.Take();
}

}  // namespace sextant
