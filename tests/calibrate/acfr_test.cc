// SPDX-License-Identifier: Apache-2.0
// The seven real pairs of acfr/cam_lidar_calibration, without manual marking.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "base/units.h"
#include "calibrate/acfr_session.h"
#include "calibrate/match/assemble.h"
#include "calibrate/trust/diagnose.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/real_data.h"

namespace sextant::test {
namespace {

// The mean of the published runs: camera poses in the LiDAR frame, R = Rz Ry Rx.
Rigid3d PublishedCamFromLidar(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double count = 0.0;
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    double v[6] = {};
    char comma = 0;
    for (double& value : v) fields >> value >> comma;
    const Eigen::Quaterniond q = FromEulerZyx({.yaw = v[2], .pitch = v[1], .roll = v[0]});
    sum += q.coeffs().dot(sum) < 0.0 ? -q.coeffs() : q.coeffs();
    translation += Eigen::Vector3d(v[3], v[4], v[5]);
    count += 1.0;
  }
  const Rigid3d lidar_from_cam{Eigen::Quaterniond(sum).normalized(), translation / count};
  return lidar_from_cam.Inverse();
}

// Seven of the pairs.
std::vector<SessionView> SevenViews(const ObservedSession& session) {
  const std::set<std::string> some = {"pose2",  "pose5",  "pose9", "pose16",
                                      "pose20", "pose26", "pose30"};
  std::vector<SessionView> views;
  for (std::size_t i = 0; i < session.views.size(); ++i) {
    const std::string name = session.session.files.pairs[i].image.stem().string();
    if (some.contains(name)) views.push_back(session.views[i]);
  }
  EXPECT_EQ(views.size(), some.size());
  return views;
}

// The point without the errors of the LiDAR that the answer states: a corner by the scan contains
// them, and the pose does not.
Eigen::Vector3d Corrected(const Eigen::Vector3d& point_in_lidar, const SolveReport& report) {
  Eigen::Vector3d point = point_in_lidar;
  for (const EstimatedNumber& number : report.extras) {
    if (number.name == "range_bias_m") point -= number.value * point_in_lidar.normalized();
    if (number.name == "beam_crossing_m") {
      point.z() -= number.value * point_in_lidar.z() / point_in_lidar.head<2>().norm();
    }
  }
  return point;
}

// RMSE of the corners of each view under the answer of the others [m], with its corrections.
double HeldOutRmse(const CalibrationProblem& problem, const char* spec) {
  const SolverPtr solver = *BuiltinSolvers().Make(spec);
  std::set<int> views;
  for (const BoardView& board : problem.board_views) views.insert(board.view);
  double squares = 0.0;
  for (const int view : views) {
    CalibrationProblem others = problem;
    const auto is_held_out = [view](const auto& pair) { return pair.id.view == view; };
    std::erase_if(others.pairs_3d3d, is_held_out);
    std::erase_if(others.pairs_2d3d, is_held_out);
    std::erase_if(others.board_views, [view](const BoardView& b) { return b.view == view; });
    const Expected<SolveReport> report = solver->Solve(others);
    EXPECT_TRUE(report) << report.error().message;
    for (const Pair3d3d& pair : problem.pairs_3d3d) {
      if (pair.id.view != view) continue;
      const Eigen::Vector3d predicted =
          report->cam_from_lidar * Corrected(pair.point_in_lidar, *report);
      squares += (pair.point_in_cam - predicted).squaredNorm();
    }
  }
  return std::sqrt(squares / static_cast<double>(problem.pairs_3d3d.size()));
}

TEST(AcfrPairs, TheBoardOfEveryPairIsMatchedAndThePoseIsThePublishedOne) {
  SEXTANT_REAL_DATA(folder, "acfr_vlp16");
  const Expected<ObservedSession>& session = AcfrSession(folder);
  ASSERT_TRUE(session) << session.error().message;
  const std::vector<SessionView> views = SevenViews(*session);
  const Expected<Assembly> assembly = Assemble(views, session->boards, session->camera);
  ASSERT_TRUE(assembly) << assembly.error().message;
  for (const BoardRow& row : assembly->rows) {
    EXPECT_EQ(row.fate, BoardStatus::kKept) << views[row.view].name << ": " << row.why;
  }
  EXPECT_TRUE(assembly->matching.alternatives.empty());
  const Rigid3d published = PublishedCamFromLidar(folder / "calibration_quickstart.csv");
  double start_m = 1.0;
  for (const char* spec : {"kabsch", "gnc(kabsch)", "joint(gnc(kabsch))"}) {
    const Expected<SolveReport> report = (*BuiltinSolvers().Make(spec))->Solve(assembly->problem);
    ASSERT_TRUE(report) << report.error().message;
    const PoseDistance off = DistanceBetween(report->cam_from_lidar.Inverse(), published.Inverse());
    // The published mean is 0.6 deg from a fit of the published corners. Joint is 1.24 deg off it,
    // and finds ranges that are 19 mm too short, which the published poses do not consider.
    const bool is_joint = std::string_view(spec).starts_with("joint");
    EXPECT_LT(off.rotation_rad * kDegPerRad, is_joint ? 1.3 : 1.2) << spec;
    EXPECT_LT(off.translation_m, 0.06) << spec;
    const double held_out_m = HeldOutRmse(assembly->problem, spec);
    EXPECT_LT(held_out_m, 0.025) << spec;
    if (is_joint) {
      EXPECT_LE(held_out_m, start_m) << spec;
    }
    start_m = held_out_m;
    EXPECT_TRUE(Diagnose(views, *assembly, report->cam_from_lidar).empty());
  }
}

}  // namespace
}  // namespace sextant::test
