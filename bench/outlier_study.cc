// SPDX-License-Identifier: Apache-2.0
#include "bench/outlier_study.h"

#include <fmt/core.h>

#include <atomic>
#include <thread>

#include "eval/synthetic/mismatched_pairs.h"

namespace sextant {
namespace {

enum class Outcome { kSuccess, kUnanswered, kWrong };

Outcome Try(const Contestant& contestant, const RandomScene& scene, int inliers) {
  CalibrationProblem problem = scene.problem;
  if (contestant.knows_inliers) problem.pairs_2d3d.resize(static_cast<std::size_t>(inliers));
  const std::optional<Rigid3d> pose = contestant.find(problem);
  if (!pose) return Outcome::kUnanswered;
  const PoseDistance off = DistanceBetween(*pose, scene.cam_from_lidar);
  const bool is_near =
      off.rotation_rad <= kSuccessRotation && off.translation_m <= kSuccessTranslation;
  return is_near ? Outcome::kSuccess : Outcome::kWrong;
}

RandomScene MakeScene(const OutlierStudy& study, int pairs, double fraction, std::size_t index) {
  const RandomSceneOptions options{
      .pairs = pairs, .sigma_px = study.sigma_px, .states_noise = study.states_noise};
  const std::string condition = fmt::format("{} pairs, {:.3f} outliers", pairs, fraction);
  Random random(DeriveSeed(study.seed, condition, 0, index));
  RandomScene scene = MakeRandomScene(options, random);
  MismatchPairs(options, InlierCount(pairs, fraction), random, scene);
  scene.problem.pairs_3d3d.clear();
  scene.problem.point_sets = {};
  return scene;
}

// Outcomes indexed by contestant and scene.
std::vector<std::vector<Outcome>> RunScenes(const OutlierStudy& study, int pairs, double fraction,
                                            std::span<const Contestant> contestants) {
  const auto count = static_cast<std::size_t>(study.scenes);
  std::vector<std::vector<Outcome>> outcomes(contestants.size(), std::vector<Outcome>(count));
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      const RandomScene scene = MakeScene(study, pairs, fraction, i);
      for (std::size_t k = 0; k < contestants.size(); ++k) {
        outcomes[k][i] = Try(contestants[k], scene, InlierCount(pairs, fraction));
      }
      study.after_scene();
    }
  };
  std::vector<std::jthread> workers;
  for (int i = 0; i < study.threads; ++i) workers.emplace_back(work);
  workers.clear();
  return outcomes;
}

std::string CellText(const OutlierCell& cell) {
  const int wrong = cell.scenes - cell.successes - cell.unanswered;
  return wrong == 0 ? std::to_string(cell.successes)
                    : fmt::format("{} ({})", cell.successes, wrong);
}

}  // namespace

Contestant ContestantOf(const SolverPtr& solver) {
  return {solver->spec().name,
          [solver](const CalibrationProblem& problem) -> std::optional<Rigid3d> {
            const Expected<SolveReport> report = solver->Solve(problem);
            if (!report) return std::nullopt;
            return report->cam_from_lidar;
          }};
}

Contestant ContestantThatKnowsInliers(const SolverPtr& solver) {
  Contestant contestant = ContestantOf(solver);
  contestant.name += ", inliers known";
  contestant.knows_inliers = true;
  return contestant;
}

std::vector<OutlierCell> StudyOutliers(const OutlierStudy& study,
                                       std::span<const Contestant> contestants) {
  std::vector<OutlierCell> cells;
  for (const int pairs : study.pairs) {
    const std::size_t first = cells.size();
    for (const Contestant& contestant : contestants) {
      for (const double fraction : study.outlier_fractions) {
        cells.push_back({contestant.name, pairs, fraction, study.scenes, 0, 0});
      }
    }
    for (std::size_t f = 0; f < study.outlier_fractions.size(); ++f) {
      const auto outcomes = RunScenes(study, pairs, study.outlier_fractions[f], contestants);
      for (std::size_t k = 0; k < contestants.size(); ++k) {
        OutlierCell& cell = cells[first + k * study.outlier_fractions.size() + f];
        for (const Outcome outcome : outcomes[k]) {
          if (outcome == Outcome::kSuccess) ++cell.successes;
          if (outcome == Outcome::kUnanswered) ++cell.unanswered;
        }
      }
    }
  }
  return cells;
}

TextTable OutlierTable(std::span<const OutlierCell> cells, int pairs) {
  std::vector<std::string> header = {"solver"};
  std::vector<std::vector<std::string>> rows;
  for (const OutlierCell& cell : cells) {
    if (cell.pairs != pairs) continue;
    if (rows.empty() || rows.back().front() != cell.contestant) rows.push_back({cell.contestant});
    if (rows.size() == 1) header.push_back(fmt::format("{:.0f} %", 100.0 * cell.outlier_fraction));
    rows.back().push_back(CellText(cell));
  }
  TextTable table(std::move(header));
  for (std::vector<std::string>& row : rows) table.AddRow(std::move(row));
  return table;
}

}  // namespace sextant
