// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "base/random.h"
#include "base/units.h"
#include "eval/experiment/definition/parameter_set.h"
#include "eval/experiment/definition/trials.h"
#include "features/camera/find_boards.h"
#include "simulator/camera/render.h"
#include "simulator/scene/camera_model.h"
#include "simulator/scene/scene_pose.h"

namespace sextant {
namespace {

struct BoardImageSettings {
  std::string camera_model = "zed_left";
  double distance_m = 2.0;
  double side_m = 0.48;
  double print_m = 0.32;
  double tilt_deg = 30.0;
};

enum BoardImageMeasured : int {
  kImageFound,
  kImageCornerMm,
  kDepthMm,
  kAcrossMm,
  kImageRotationDeg,
  kAmbiguous
};

const std::vector<Metric>& BoardImageMetrics() {
  static const std::vector<Metric> metrics = {
      {"found", "1 if the print was found and gave a pose, else 0"},
      {"corner_mm", "RMS distance of the board's corners from the true corners"},
      {"depth_mm", "absolute error of the board's centre along the line of sight"},
      {"across_mm", "error of the board's centre across the line of sight"},
      {"rotation_deg", "error of the board's rotation"},
      {"ambiguous", "1 if another pose fits nearly as well, else 0"},
  };
  return metrics;
}

const ParameterSet<BoardImageSettings>& BoardImageParameters() {
  static const ParameterSet<BoardImageSettings> set =
      ParameterSet<BoardImageSettings>()
          .Text("camera_model", &BoardImageSettings::camera_model, "name", "see docs/simulator.md")
          .Real("distance_m", &BoardImageSettings::distance_m, "m", 0.3, 100.0,
                "from camera to board")
          .Real("side_m", &BoardImageSettings::side_m, "m", 0.05, 10.0, "side of the square board")
          .Real("print_m", &BoardImageSettings::print_m, "m", 0.02, 9.0,
                "side of the tag, or of the whole checkerboard")
          .Real("tilt_deg", &BoardImageSettings::tilt_deg, "deg", 0.0, 70.0,
                "maximum yaw and pitch of the board");
  return set;
}

// The same area printed in three ways.
Board PrintedBoard(const BoardImageSettings& settings, std::size_t print) {
  constexpr int kSquares = 8;
  Board board{.id = 0, .top_right_m = settings.side_m, .right_bottom_m = settings.side_m};
  if (print == 2) {
    board.checker = BoardChecker{.inner_columns = kSquares - 1,
                                 .inner_rows = kSquares - 2,
                                 .square_m = settings.print_m / kSquares};
  } else {
    board.tags = {{.family = print == 0 ? "aruco_original" : "tag36h11",
                   .id = 26,
                   .edge_m = settings.print_m}};
  }
  return board;
}

class BoardImageTrials final : public Trials {
 public:
  static Expected<TrialsPtr> Make(const BoardImageSettings& settings) {
    auto trials = std::make_shared<BoardImageTrials>();
    trials->settings_ = settings;
    SEXTANT_ASSIGN_OR_RETURN(const Camera camera, FindCameraModel(settings.camera_model));
    for (std::size_t i = 0; i < trials->subjects().size(); ++i) {
      SEXTANT_ASSIGN_OR_RETURN(BoardFinder finder,
                               BoardFinder::Make({PrintedBoard(settings, i)}, camera));
      trials->finders_.push_back(std::move(finder));
    }
    return trials;
  }

  const std::vector<std::string>& subjects() const override {
    static const std::vector<std::string> names = {"ArUco tag", "AprilTag 36h11",
                                                   "checkerboard 8 x 7"};
    return names;
  }

  void Run(const TrialId& id, TrialRows& rows) const override {
    Random random(DeriveSeed(id.seed, "board", 0, 0));
    EulerZyx turn;
    turn.yaw = kRadPerDeg * random.Uniform(-settings_.tilt_deg, settings_.tilt_deg);
    turn.pitch = kRadPerDeg * random.Uniform(-settings_.tilt_deg, settings_.tilt_deg);
    turn.roll = kRadPerDeg * (45.0 + random.Uniform(-5.0, 5.0));
    const double side = 0.15 * settings_.distance_m * random.Uniform(-1.0, 1.0);
    const double height = 0.1 * settings_.distance_m * random.Uniform(-1.0, 1.0);
    for (std::size_t i = 0; i < finders_.size(); ++i) {
      Scene scene;
      scene.name = "one board";
      SceneCamera camera{.name = "cam", .model = settings_.camera_model};
      camera.world_from_cam = {SceneRotation(SceneAxes::kForwardIsZ, {}), Eigen::Vector3d::Zero()};
      SceneBoard board{.board = PrintedBoard(settings_, i)};
      board.world_from_board = {SceneRotation(SceneAxes::kForwardIsZ, turn),
                                {settings_.distance_m, side, height}};
      scene.cameras.push_back(camera);
      scene.boards.push_back(board);
      const Expected<cv::Mat> image = RenderImage(scene, 0, UsualImageOptions(id.seed, 0.0));
      Measure(image, i, camera.world_from_cam.Inverse() * board.world_from_board,
              rows.Add(static_cast<int>(i)));
    }
  }

 private:
  void Measure(const Expected<cv::Mat>& image, std::size_t print, const Rigid3d& truth,
               MetricValues values) const {
    values.Set(kImageFound, 0.0);
    if (!image) return;
    const Expected<SeenBoards> seen = finders_[print].Find(*image);
    if (!seen || !seen->boards[0].pose || !*seen->boards[0].pose) return;
    const BoardPose& pose = **seen->boards[0].pose;
    values.Set(kImageFound, 1.0);
    values.Set(kAmbiguous, pose.ambiguous_with ? 1.0 : 0.0);
    double squares = 0.0;
    for (const Eigen::Vector3d& corner : BoardCorners(PrintedBoard(settings_, print))) {
      squares += 0.25 * (pose.cam_from_board * corner - truth * corner).squaredNorm();
    }
    values.Set(kImageCornerMm, 1e3 * std::sqrt(squares));
    const Eigen::Vector3d sight = truth.translation.normalized();
    const Eigen::Vector3d off = pose.cam_from_board.translation - truth.translation;
    const double along = sight.dot(off);
    values.Set(kDepthMm, 1e3 * std::abs(along));
    values.Set(kAcrossMm, 1e3 * (off - along * sight).norm());
    values.Set(kImageRotationDeg,
               RotationDistance(pose.cam_from_board.rotation, truth.rotation) / kRadPerDeg);
  }

  BoardImageSettings settings_;
  std::vector<BoardFinder> finders_;
};

Expected<TrialsPtr> MakeBoardImageTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const BoardImageSettings settings,
                           BoardImageParameters().Parse(arguments.parameters));
  return BoardImageTrials::Make(settings);
}

}  // namespace

TrialKind BoardImageKind() {
  return {.name = "board_image",
          .summary = "one board in a rendered image, printed with a tag or as a checkerboard",
          .takes_solvers = false,
          .parameters = BoardImageParameters().Describe(),
          .metrics = BoardImageMetrics(),
          .trials_per_block = 5,
          .make = MakeBoardImageTrials};
}

}  // namespace sextant
