// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <opencv2/core/mat.hpp>

#include "calibrate/observe/observe.h"
#include "calibrate/observe/photo_file.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/pose_argument.h"
#include "cli/progress.h"
#include "io/boards/board_file.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/cloud_file.h"
#include "io/output/standard_output.h"
#include "report/calibrate_text.h"
#include "report/scan_on_image.h"
#include "report/thinned_scan.h"

namespace sextant::cli {
namespace {

struct ProjectOptions {
  std::string image_path{};
  std::string cloud_path{};
  std::string result_path{};
  std::string pose_is{};
  PairNames names{};
  std::string camera_path{};  ///< Empty: the result's.
  std::string boards_path{};  ///< Empty: the result's; they are searched for in the image.
  std::string out_path{};
  double point_px = 0.0;     ///< Diameter of a return; 0: by the image's size.
  bool all_returns = false;  ///< Also those that something nearer hides from the camera.
};

void Declare(ProjectOptions& options, Arguments& arguments) {
  arguments.Add("--image", options.image_path, "The photo", {.required = true});
  arguments.Add("--cloud", options.cloud_path,
                "Its scan: PCD, PLY, LAS, npy, KITTI .bin or a table (.csv, .xyz)",
                {.required = true});
  arguments.Add("--result", options.result_path,
                std::string(kPoseHelp) + ",\nor rig.json of sextant rig", {.required = true});
  DeclarePoseIs(options.pose_is, arguments);
  DeclarePairNames(options.names, arguments);
  arguments.Add("--out", options.out_path, "Picture to write (.png or .jpg)",
                {.required = true, .writes = Writes::kFile});
  arguments.Add("--camera", options.camera_path, "Intrinsics; default: the result's");
  arguments.Add("--board", options.boards_path,
                "Boards to outline, by the image and by the scan; default: the result's");
  arguments.Add("--point-size", options.point_px,
                "Diameter of a return [px]; 0: by the size of the image",
                {.range = {{0.0, 100.0}}});
  arguments.Add("--all", options.all_returns,
                "Draw also the returns that something nearer hides from the camera");
}

const cv::Scalar kByImage(0, 160, 255);
const cv::Scalar kByScan(255, 255, 255);

// The corners of one board by each sensor, in the camera frame; empty if it was not found.
struct BoardInBoth {
  std::vector<Eigen::Vector3d> by_image;
  std::vector<Eigen::Vector3d> by_scan;
};

struct Inputs {
  CalibrationResult result;
  Camera camera;
  PointCloud cloud;
  cv::Mat image;
};

Expected<Inputs> ReadInputs(const ProjectOptions& options) {
  Inputs inputs;
  SEXTANT_ASSIGN_OR_RETURN(CalibrationResult result,
                           ResultOfFile(options.result_path, options.pose_is, options.names));
  if (!options.camera_path.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const Camera camera, ReadCamera(options.camera_path));
    result.camera = camera;
  }
  if (!result.camera) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("{} has no camera; expected its key 'camera', or --camera",
                                 options.result_path));
  }
  inputs.camera = *result.camera;
  if (!options.boards_path.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(std::vector<Board> boards, ReadBoards(options.boards_path));
    result.boards = std::move(boards);
  }
  inputs.result = std::move(result);
  SEXTANT_ASSIGN_OR_RETURN(const PointCloud cloud, ReadCloud(options.cloud_path));
  inputs.cloud = cloud;
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat image, ReadColourImage(options.image_path));
  inputs.image = image;
  return inputs;
}

// A camera whose file has no image size is assumed to have that of the image.
Expected<void> FitCamera(const std::string& image_path, Inputs& inputs) {
  Camera& camera = inputs.camera;
  if (camera.width_px == 0) camera.width_px = inputs.image.cols;
  if (camera.height_px == 0) camera.height_px = inputs.image.rows;
  if (camera.width_px == inputs.image.cols && camera.height_px == inputs.image.rows) return {};
  return MakeError(
      ErrorCode::kInvalidInput,
      fmt::format("{} is {} x {} pixels, the camera {} x {}: expected the same", image_path,
                  inputs.image.cols, inputs.image.rows, camera.width_px, camera.height_px));
}

// The most likely placement of that board on a patch; null if there is none. Placements differ in
// which corner is which, not in the outline.
const BoardPlacement* PlacementOf(const LidarSighting& sighting, int board) {
  const auto found =
      std::find_if(sighting.placements.begin(), sighting.placements.end(),
                   [board](const BoardPlacement& placement) { return placement.board == board; });
  return found == sighting.placements.end() ? nullptr : &*found;
}

Eigen::Vector3d CentreOf(const std::vector<Eigen::Vector3d>& corners) {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

// Two patches may both have the size of the board: the one nearer to its place in the image.
void ChooseScan(const std::vector<Eigen::Vector3d>& corners, BoardInBoth& board) {
  if (!board.by_scan.empty() && !board.by_image.empty()) {
    const Eigen::Vector3d by_image = CentreOf(board.by_image);
    if ((CentreOf(corners) - by_image).norm() > (CentreOf(board.by_scan) - by_image).norm()) return;
  }
  board.by_scan = corners;
}

Expected<std::vector<BoardInBoth>> FindInBoth(const Inputs& inputs) {
  std::vector<BoardInBoth> boards(inputs.result.boards.size());
  if (boards.empty()) return boards;
  SEXTANT_ASSIGN_OR_RETURN(const Observer observer,
                           Observer::Make(inputs.result.boards, inputs.camera));
  const std::size_t step = ThinningOf(inputs.cloud);
  SEXTANT_ASSIGN_OR_RETURN(const Observation seen,
                           step > 1 ? observer.Observe(inputs.image, Thinned(inputs.cloud, step))
                                    : observer.Observe(inputs.image, inputs.cloud));
  for (const CameraSighting& sighting : seen.in_image) {
    boards[static_cast<std::size_t>(sighting.board)].by_image = sighting.corners.points;
  }
  for (const LidarSighting& sighting : seen.in_scan) {
    for (std::size_t i = 0; i < boards.size(); ++i) {
      const BoardPlacement* placement = PlacementOf(sighting, static_cast<int>(i));
      if (placement == nullptr) continue;
      std::vector<Eigen::Vector3d> corners;
      for (const Eigen::Vector3d& corner : placement->corners.in_lidar) {
        corners.push_back(inputs.result.cam_from_lidar * corner);
      }
      ChooseScan(corners, boards[i]);
    }
  }
  return boards;
}

std::string Describe(const BoardInBoth& board, const Board& known, const Camera& camera) {
  const std::string name =
      known.name.empty() ? fmt::format("board {}", known.id) : fmt::format("board {}", known.name);
  if (board.by_image.empty() && board.by_scan.empty()) return name + ": in neither sensor\n";
  if (board.by_image.empty()) return name + ": outlined by the scan only (white)\n";
  if (board.by_scan.empty()) return name + ": outlined by the image only (orange)\n";
  const Eigen::Vector3d by_image = CentreOf(board.by_image);
  const Eigen::Vector3d by_scan = CentreOf(board.by_scan);
  std::string text = fmt::format("{}: its centre by image (orange) and scan (white) {:.1f} mm",
                                 name, (by_image - by_scan).norm() * 1e3);
  const auto a = Project(camera, by_image);
  const auto b = Project(camera, by_scan);
  if (a && b) text += fmt::format(", {:.1f} px", (*a - *b).norm());
  return text + " apart\n";
}

int Run(const ProjectOptions& options) {
  Progress progress;
  ProgressCounter steps(progress.Callback(), "project", 4);
  Expected<Inputs> inputs = ReadInputs(options);
  steps.Step();
  if (!inputs) return Refuse("project", inputs.error());
  if (const Expected<void> ok = FitCamera(options.image_path, *inputs); !ok) {
    return Refuse("project", ok.error());
  }
  const Expected<std::vector<BoardInBoth>> boards = FindInBoth(*inputs);
  if (!boards) return Refuse("project", boards.error());
  steps.Step();
  cv::Mat canvas = inputs->image.clone();
  const ScanOnImage drawn =
      DrawScanOnImage(inputs->cloud, inputs->camera, inputs->result.cam_from_lidar,
                      {.point_px = options.point_px, .all_returns = options.all_returns}, canvas);
  steps.Step();
  std::string text =
      fmt::format("{} on {}: {} of {} returns in view, {} of them hidden by something nearer{}\n",
                  options.cloud_path, options.image_path, drawn.in_view, drawn.returns,
                  drawn.hidden, options.all_returns ? " and drawn nevertheless" : "");
  for (std::size_t i = 0; i < boards->size(); ++i) {
    DrawOutline((*boards)[i].by_image, inputs->camera, kByImage, canvas);
    DrawOutline((*boards)[i].by_scan, inputs->camera, kByScan, canvas);
    text += Describe((*boards)[i], inputs->result.boards[i], inputs->camera);
  }
  if (const Expected<void> ok = WriteImage(canvas, options.out_path); !ok) {
    return Refuse("project", ok.error());
  }
  steps.Finish();
  Print("{}{}{}", CautionAbout(inputs->result), text,
        WroteLine(options.out_path, "the scan on its image"));
  if (drawn.in_view > 0) return kAnswered;
  return Refuse("project",
                {ErrorCode::kInvalidInput,
                 fmt::format("no return of {} falls on {}; is the result of these sensors, and is "
                             "cam_from_lidar not its inverse?",
                             options.cloud_path, options.image_path)},
                kNoAnswer);
}

}  // namespace

Command ProjectCommand() {
  constexpr const char* kFooter =
      "Returns are coloured by range. If the answer is right, their colour changes at the edges "
      "in\n"
      "the image, and the two outlines of a board coincide.\n"
      "Example:\n  sextant project --image photo.png --cloud scan.pcd --result result.yaml --out "
      "projected.png\n"
      "  sextant project --image left.png --cloud top.pcd --result rig.json --camera-name left "
      "--lidar-name top --out projected.png";
  return MakeCommand<ProjectOptions>("project", "A scan drawn on its image with a result", kFooter,
                                     Declare, Run);
}

}  // namespace sextant::cli
