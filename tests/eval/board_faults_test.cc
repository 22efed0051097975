// SPDX-License-Identifier: Apache-2.0
// Boards whose corners are listed from another one on, boards that moved, and a wrong size: what
// the diagnostics say, and that they say nothing of boards without faults.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/random.h"
#include "eval/diagnostics/pair_diagnostics.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

struct BoardsOptions {
  int boards = 1;
  double width_m = 0.6;
  double height_m = 0.45;
  double sigma_m = 0.005;
  double sigma_px = 0.3;
  bool in_pixels = false;
  double shared_m = 0.0;  ///< An error that the LiDAR's points of a board share.
  double outliers = 0.0;  ///< Share of the pairs, 0.3 m or 60 px off.
};

/// An upright camera next to the LiDAR.
Rigid3d MountedCamera() {
  Eigen::Matrix3d axes;
  axes << 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0;
  const Eigen::Quaterniond turn(axes);
  return {ExpSo3({0.02, -0.03, 0.01}) * turn, {0.06, -0.11, -0.07}};
}

/// Boards of any tilt up to 35 deg in the image, at 1.5 to 4 m.
class BoardsInView {
 public:
  BoardsInView(const BoardsOptions& options, std::uint64_t seed)
      : options_(options), random_(DeriveSeed(1, "boards", 0, seed)) {
    problem_.camera = Camera{.width_px = 1280,
                             .height_px = 720,
                             .fx_px = 800.0,
                             .fy_px = 810.0,
                             .cx_px = 640.0,
                             .cy_px = 360.0};
    for (int board = 0; board < options.boards; ++board) AddBoard(board);
  }

  CalibrationProblem& problem() { return problem_; }

  /// The LiDAR's corners of a board from `corners` later on.
  void Turn(int board, std::size_t corners) {
    std::vector<Eigen::Vector3d*> points;
    for (Pair3d3d& pair : problem_.pairs_3d3d) {
      if (pair.id.board == board) points.push_back(&pair.point_in_lidar);
    }
    for (Pair2d3d& pair : problem_.pairs_2d3d) {
      if (pair.id.board == board) points.push_back(&pair.point_in_lidar);
    }
    std::vector<Eigen::Vector3d> turned;
    for (std::size_t i = 0; i < points.size(); ++i) {
      turned.push_back(*points[(i + corners) % points.size()]);
    }
    for (std::size_t i = 0; i < points.size(); ++i) *points[i] = turned[i];
  }

  void Move(int board, const Eigen::Vector3d& in_lidar) {
    for (Pair3d3d& pair : problem_.pairs_3d3d) {
      if (pair.id.board == board) pair.point_in_lidar += in_lidar;
    }
    for (Pair2d3d& pair : problem_.pairs_2d3d) {
      if (pair.id.board == board) pair.point_in_lidar += in_lidar;
    }
  }

 private:
  double Uniform(double from, double to) { return from + (to - from) * random_.Uniform(); }
  Eigen::Vector3d Noise(double sigma) {
    const double x = random_.Normal();
    const double y = random_.Normal();
    const double z = random_.Normal();
    return sigma * Eigen::Vector3d(x, y, z);
  }

  void AddBoard(int board) {
    const Camera& camera = *problem_.camera;
    std::vector<Eigen::Vector3d> corners;
    do {
      corners.clear();
      const double z = Uniform(1.5, 4.0);
      const double u = Uniform(150.0, 1130.0);
      const double v = Uniform(130.0, 590.0);
      const Eigen::Vector3d middle((u - camera.cx_px) / camera.fx_px * z,
                                   (v - camera.cy_px) / camera.fy_px * z, z);
      const double tilt_x = Uniform(-0.6, 0.6);
      const double tilt_y = Uniform(-0.6, 0.6);
      const double roll = Uniform(0.0, 6.28);
      const Eigen::Quaterniond turn = ExpSo3({tilt_x, tilt_y, 0.0}) * ExpSo3({0.0, 0.0, roll});
      for (const auto& [x, y] :
           {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
        corners.push_back(middle + turn * Eigen::Vector3d(0.5 * options_.width_m * x,
                                                          0.5 * options_.height_m * y, 0.0));
      }
    } while (!std::ranges::all_of(corners, [&](const Eigen::Vector3d& corner) {
      const auto pixel = Project(camera, corner);
      return pixel && pixel->x() > 0.0 && pixel->x() < 1279.0 && pixel->y() > 0.0 &&
             pixel->y() < 719.0;
    }));
    const Rigid3d lidar_from_cam = MountedCamera().Inverse();
    const Eigen::Vector3d shared = Noise(options_.shared_m);
    for (int corner = 0; corner < 4; ++corner) {
      const Eigen::Vector3d& in_cam = corners[static_cast<std::size_t>(corner)];
      const Eigen::Vector3d in_lidar = lidar_from_cam * in_cam + shared;
      const bool is_outlier = random_.Uniform() < options_.outliers;
      const Eigen::Vector3d error = Noise(1.0).normalized();
      const PairId id{.view = 0, .board = board, .corner = corner};
      if (options_.in_pixels) {
        const Eigen::Vector2d noise = Noise(options_.sigma_px).head<2>();
        const Eigen::Vector2d far = (is_outlier ? 60.0 : 0.0) * error.head<2>();
        problem_.pairs_2d3d.push_back({.pixel = *Project(camera, in_cam) + noise + far,
                                       .point_in_lidar = in_lidar,
                                       .sigma_px = 0.0,
                                       .id = id});
      } else {
        Pair3d3d pair;
        pair.point_in_cam = in_cam + Noise(options_.sigma_m) + (is_outlier ? 0.3 : 0.0) * error;
        pair.point_in_lidar = in_lidar;
        pair.id = id;
        problem_.pairs_3d3d.push_back(pair);
      }
    }
  }

  BoardsOptions options_;
  Random random_;
  CalibrationProblem problem_;
};

bool IsNearTruth(const Rigid3d& pose) {
  const PoseDistance distance = DistanceBetween(pose, MountedCamera());
  return distance.translation_m < 0.25 && distance.rotation_rad < 0.15;
}

constexpr std::uint64_t kSeeds = 20;

TEST(TurnedBoards, OneBoardUpsideDownIsTurnedBack) {
  for (const bool in_pixels : {false, true}) {
    int found = 0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      BoardsInView boards({.in_pixels = in_pixels}, seed);
      boards.Turn(0, 2);
      const PairDiagnostics diagnostics = DiagnosePairs(boards.problem());
      if (!diagnostics.order.better) continue;
      ++found;
      EXPECT_TRUE(RefutesPoses(diagnostics, false)) << seed;
      EXPECT_FALSE(RefutesPoses(diagnostics, true)) << seed;
      EXPECT_EQ(diagnostics.order.better->turned_deg, 180) << seed;
      EXPECT_TRUE(IsNearTruth(diagnostics.order.better->cam_from_lidar)) << seed;
      EXPECT_THAT(Describe(diagnostics), Contains(HasSubstr("upside down"))) << seed;
    }
    EXPECT_GE(found, 17) << in_pixels;
  }
}

TEST(TurnedBoards, AQuarterTurnOfASquareBoardIsSaid) {
  for (const std::size_t corners : {1U, 3U}) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      BoardsInView boards({.width_m = 0.5, .height_m = 0.5}, seed);
      boards.Turn(0, corners);
      const PairDiagnostics diagnostics = DiagnosePairs(boards.problem());
      EXPECT_FALSE(diagnostics.order.turned.empty()) << seed;
      EXPECT_THAT(Describe(diagnostics), Contains(HasSubstr("which corner is first"))) << seed;
    }
  }
}

TEST(TurnedBoards, AQuarterTurnOfARectangleInPixelsFitsFarWorse) {
  int refuted = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    BoardsInView boards({.in_pixels = true}, seed);
    boards.Turn(0, 1);
    refuted += RefutesPoses(DiagnosePairs(boards.problem()), false) ? 1 : 0;
  }
  EXPECT_GE(refuted, 18);
}

// The note does not refuse an honest answer.
TEST(TurnedBoards, OneBoardInOrderIsUsable) {
  for (const bool in_pixels : {false, true}) {
    for (const double height_m : {0.45, 0.6}) {
      for (std::uint64_t seed = 1; seed <= 4 * kSeeds; ++seed) {
        BoardsInView boards({.height_m = height_m, .in_pixels = in_pixels}, seed);
        const PairDiagnostics diagnostics = DiagnosePairs(boards.problem());
        EXPECT_FALSE(RefutesPoses(diagnostics, false)) << seed;
      }
    }
  }
}

// A checkerboard of 7 x 5 corners looks the same from both ends, in every view of one place.
TEST(TurnedBoards, ACheckerboardHasTwoEnds) {
  const Rigid3d lidar_from_cam = MountedCamera().Inverse();
  CalibrationProblem problem;
  Random random(3);
  for (int view = 0; view < 2; ++view) {
    for (int i = 0; i < 35; ++i) {
      const Eigen::Vector3d in_cam(0.1 * (i % 7) - 0.2, 0.1 * static_cast<double>(i / 7), 3.0);
      Pair3d3d pair;
      pair.point_in_lidar = lidar_from_cam * in_cam;
      pair.point_in_cam = in_cam + 0.003 * Eigen::Vector3d::Constant(random.Normal());
      pair.id = {.view = view, .board = 0, .corner = i};
      problem.pairs_3d3d.push_back(pair);
    }
  }
  const OrderDiagnosis order = DiagnoseOrder(problem);
  ASSERT_EQ(order.turned.size(), 1U);
  EXPECT_EQ(order.turned[0].turned_deg, 180);
  EXPECT_EQ(order.turned[0].lidar_index[0], 34);
  EXPECT_EQ(order.turned[0].lidar_index[36], 68);
  EXPECT_FALSE(order.better);
  problem.pairs_3d3d.pop_back();
  EXPECT_THAT(DiagnoseOrder(problem).turned, IsEmpty());
}

TEST(TurnedBoards, BoardsAtTwoPlacesTellTheCornersApart) {
  for (const bool in_pixels : {false, true}) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      BoardsInView boards({.boards = 2, .in_pixels = in_pixels}, seed);
      EXPECT_THAT(DiagnoseOrder(boards.problem()).turned, IsEmpty()) << seed;
    }
  }
}

TEST(ExchangedPairs, AreThoseOfASlipAndNotOfATurnedBoard) {
  BoardsInView boards({.boards = 3}, 1);
  std::vector<Pair3d3d>& pairs = boards.problem().pairs_3d3d;
  std::swap(pairs[1].point_in_lidar, pairs[10].point_in_lidar);
  const PairDiagnostics diagnostics = DiagnosePairs(boards.problem());
  ASSERT_TRUE(diagnostics.order.better);
  EXPECT_THAT(ExchangedPairs(*diagnostics.order.better),
              testing::ElementsAre(testing::ElementsAre(1, 10)));
  EXPECT_THAT(Describe(diagnostics), Contains(HasSubstr("pairs 2 and 11 are exchanged")));
  BoardsInView turned({.boards = 4}, 1);
  turned.Turn(0, 2);
  const OrderDiagnosis order = DiagnoseOrder(turned.problem());
  ASSERT_TRUE(order.better);
  EXPECT_THAT(ExchangedPairs(*order.better), IsEmpty());
}

TEST(BoardContradictions, OneOfTwoBoardsMoved) {
  for (const bool in_pixels : {false, true}) {
    int found = 0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      BoardsInView boards({.boards = 2, .in_pixels = in_pixels}, seed);
      boards.Move(1, {0.1, -0.3, 0.0});
      const PairDiagnostics diagnostics = DiagnosePairs(boards.problem());
      if (!diagnostics.contradiction || !diagnostics.contradiction->is_undecided) continue;
      ++found;
      EXPECT_EQ(diagnostics.contradiction->in_pixels, in_pixels);
      EXPECT_TRUE(RefutesPoses(diagnostics, false)) << seed;
      EXPECT_TRUE(RefutesPoses(diagnostics, true)) << seed;
      EXPECT_THAT(Describe(diagnostics), Contains(HasSubstr("neither side outnumbers"))) << seed;
      EXPECT_THAT(Describe(diagnostics), Each(Not(StartsWith("scale")))) << seed;
    }
    EXPECT_GE(found, in_pixels ? 12 : 15);
  }
}

TEST(BoardContradictions, TheMajorityDecides) {
  int found = 0;
  int undecided = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    BoardsInView boards({.boards = 4}, seed);
    boards.Move(1, {0.1, -0.3, 0.0});
    const PairDiagnostics diagnostics = DiagnosePairs(boards.problem());
    found += diagnostics.contradiction ? 1 : 0;
    EXPECT_FALSE(RefutesPoses(diagnostics, false)) << seed;
    boards.Move(2, {0.1, -0.3, 0.0});
    undecided += RefutesPoses(DiagnosePairs(boards.problem()), false) ? 1 : 0;
  }
  EXPECT_GE(found, 18);
  EXPECT_GE(undecided, 17);
}

// The directions that an answer determines are those of the pairs that it uses.
TEST(BoardContradictions, WeakDirectionsAreThoseOfTheAnswer) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    BoardsInView boards({.boards = 4}, seed);
    boards.Move(3, {0.1, -0.3, 0.0});
    const PairDiagnostics moved = DiagnosePairs(boards.problem());
    SolveReport report;
    for (int i = 0; i < 16; ++i) report.inliers.push_back(i);
    const PairDiagnostics of_all = ForAnswer(moved, boards.problem(), report);
    EXPECT_EQ(Describe(of_all), Describe(moved)) << seed;
    report.inliers.resize(12);
    const PairDiagnostics of_answer = ForAnswer(moved, boards.problem(), report);
    if (!moved.weak_translation || !of_answer.weak_translation) continue;
    ++compared;
    EXPECT_LT(of_answer.weak_translation->sigma, 0.5 * moved.weak_translation->sigma) << seed;
  }
  EXPECT_GE(compared, 3);
}

TEST(BoardScale, TwoBoardsOfAWrongSizeAreNamedBeforeTheirEdges) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    BoardsInView boards({.boards = 2, .sigma_m = 0.007}, seed);
    for (Pair3d3d& pair : boards.problem().pairs_3d3d) pair.point_in_cam *= 1.06;
    const std::vector<std::string> lines = Describe(DiagnosePairs(boards.problem()));
    if (lines.empty() || lines.front().find("camera's lengths are 1.0") == std::string::npos) {
      continue;
    }
    ++found;
    EXPECT_THAT(lines, Each(Not(StartsWith("edges")))) << seed;
  }
  EXPECT_GE(found, 17);
}

// What the pairs of no pose leave is no weak direction.
TEST(WeakDirections, AreNotNamedOfPairsThatDoNotBelongTogether) {
  Random random(7);
  CalibrationProblem problem;
  for (int i = 0; i < 14; ++i) {
    Pair3d3d pair;
    for (int axis = 0; axis < 3; ++axis) {
      pair.point_in_cam[axis] = random.Normal() + (axis == 2 ? 9.0 : 0.0);
      pair.point_in_lidar[axis] = random.Normal() + (axis == 0 ? 9.0 : 0.0);
    }
    pair.id.board = i;
    problem.pairs_3d3d.push_back(pair);
  }
  EXPECT_THAT(Describe(DiagnosePairs(problem)), Each(Not(StartsWith("weak"))));
}

TEST(BoardFaults, AreNotSeenInBoardsWithoutFaults) {
  int false_alarms = 0;
  int scenes = 0;
  for (const bool in_pixels : {false, true}) {
    for (int count = 2; count <= 6; count += 2) {
      for (const double noise : {1.0, 6.0}) {
        for (const double outliers : {0.0, 0.1}) {
          for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
            BoardsInView boards({.boards = count,
                                 .sigma_m = 0.004 * noise,
                                 .sigma_px = 0.3 * noise,
                                 .in_pixels = in_pixels,
                                 .shared_m = count > 2 ? 0.01 : 0.0,
                                 .outliers = outliers},
                                seed);
            const PairDiagnostics diagnostics = DiagnosePairs(boards.problem());
            const bool is_said = diagnostics.contradiction && diagnostics.contradiction->in_pixels;
            const bool is_undecided =
                diagnostics.contradiction && diagnostics.contradiction->is_undecided;
            false_alarms += is_said || is_undecided || !diagnostics.order.turned.empty() ? 1 : 0;
            ++scenes;
          }
        }
      }
    }
  }
  EXPECT_LE(false_alarms, scenes / 100);
}

}  // namespace
}  // namespace sextant
