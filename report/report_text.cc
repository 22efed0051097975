// SPDX-License-Identifier: Apache-2.0
#include "report/report_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "base/units.h"
#include "eval/statistics/text_table.h"
#include "report/wrapped_text.h"

namespace sextant {
namespace {

// If there are more residuals than fit on a screen, only the JSON has them.
constexpr std::size_t kMaxResiduals = 64;

std::string DescribePose(const Rigid3d& pose) {
  std::string text = "  cam_from_lidar\n";
  const Eigen::Matrix4d m = pose.Matrix();
  for (int row = 0; row < 4; ++row) {
    text += fmt::format("    {:12.8f} {:12.8f} {:12.8f} {:12.8f}\n", m(row, 0), m(row, 1),
                        m(row, 2), m(row, 3));
  }
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const EulerZyx euler = ToEulerZyx(q);
  text += fmt::format("  translation x y z          {:.6f} {:.6f} {:.6f} m\n", t.x(), t.y(), t.z());
  text += fmt::format("  quaternion w x y z         {:.8f} {:.8f} {:.8f} {:.8f}\n", sign * q.w(),
                      sign * q.x(), sign * q.y(), sign * q.z());
  text += fmt::format("  yaw pitch roll (ZYX)       {:.4f} {:.4f} {:.4f} deg\n",
                      euler.yaw * kDegPerRad, euler.pitch * kDegPerRad, euler.roll * kDegPerRad);
  return text;
}

std::size_t CountProjected(const Evaluation& evaluation) {
  return static_cast<std::size_t>(std::count_if(evaluation.per_pair_px.begin(),
                                                evaluation.per_pair_px.end(),
                                                [](double r) { return std::isfinite(r); }));
}

// Where an answer leaves pairs out, the RMSE of the others, which is that of its noise.
template <class TextOf>
std::string RmseOfUsed(const SolveReport& report, const std::vector<double>& residuals,
                       const TextOf& text_of) {
  // The inliers are indices into pairs of one kind only.
  const bool one_kind =
      report.evaluation.per_pair_m.empty() || report.evaluation.per_pair_px.empty();
  const std::size_t used = report.inliers.size();
  if (!one_kind || used == 0 || used >= residuals.size()) return {};
  double squares = 0.0;
  for (const int i : report.inliers) {
    const double residual = residuals[static_cast<std::size_t>(i)];
    if (!std::isfinite(residual)) return {};
    squares += residual * residual;
  }
  return fmt::format(", {} over the {} used",
                     text_of(std::sqrt(squares / static_cast<double>(used))), used);
}

// Three pairs of any kind determine a pose; with more there is another reason.
const char* WhyNoCovariance(const SolveReport& report) {
  constexpr std::size_t kExact = 3;
  if (report.inliers.size() <= kExact) return "no redundant data";
  return CountProjected(report.evaluation) < report.evaluation.per_pair_px.size()
             ? "a point that the answer uses does not project"
             : "the data leaves a direction of the pose undetermined";
}

std::string DescribeUncertainty(const SolveReport& report) {
  if (!report.covariance) {
    return fmt::format("  1 sigma                    uncertainty unavailable: {}\n",
                       WhyNoCovariance(report));
  }
  const Vector6d sigma = report.covariance->diagonal().cwiseMax(0.0).cwiseSqrt();
  return fmt::format(
      "  1 sigma, about x y z       {:.4f} {:.4f} {:.4f} deg\n"
      "  1 sigma, along x y z       {:.2f} {:.2f} {:.2f} mm\n",
      sigma[0] * kDegPerRad, sigma[1] * kDegPerRad, sigma[2] * kDegPerRad, sigma[3] * kMmPerM,
      sigma[4] * kMmPerM, sigma[5] * kMmPerM);
}

// The noise of one kind of pairs; empty where it is stated.
std::string DescribeNoise(const SolveReport& report) {
  if (!report.noise) return {};
  const NoiseEstimate& noise = *report.noise;
  const bool of_points = noise.sigma_m.has_value();
  const auto text_of = [&](double sigma) {
    return of_points ? fmt::format("{:.2f} mm", sigma * kMmPerM) : fmt::format("{:.3f} px", sigma);
  };
  const Evaluation& evaluation = report.evaluation;
  std::string text =
      fmt::format("  noise of a pair, 1 sigma   {}{}, {} {} of {} pairs\n",
                  text_of(of_points ? *noise.sigma_m : *noise.sigma_px),
                  of_points && noise.sigma_px ? fmt::format(" and {:.3f} px", *noise.sigma_px) : "",
                  noise.is_given ? "as given, used" : "estimated from", report.inliers.size(),
                  of_points ? evaluation.per_pair_m.size() : evaluation.per_pair_px.size());
  if (noise.is_given) return text;
  constexpr const char* kLabel = "                             ";
  if (noise.board_errors == BoardErrors::kAssumedIndependent) {
    return text + kLabel + "independent errors assumed: no board or view names several pairs\n";
  }
  if (noise.board_errors == BoardErrors::kTooFewBoards) return text;
  return text + fmt::format("{}{} of it common to each of {} boards\n", kLabel,
                            text_of(noise.shared_sigma), noise.boards);
}

std::string DescribeNumbers(const char* title, const std::vector<EstimatedNumber>& numbers) {
  std::string text = fmt::format("  {}\n", title);
  for (const EstimatedNumber& number : numbers) {
    const std::string sigma = number.sigma ? fmt::format("{:.2g}", *number.sigma) : "not known";
    text += fmt::format("    {:<24} {:.6g}, 1 sigma {}\n", number.name, number.value, sigma);
  }
  return text;
}

std::string DescribeBoardViews(const std::vector<BoardViewFit>& fits) {
  TextTable table({"  board views", "board", "used", "printed", "face", "edges", "rms [sigma]"});
  const auto of = [](const ObservationCount& count) {
    return fmt::format("{}/{}", count.used, count.of);
  };
  for (const BoardViewFit& fit : fits) {
    table.AddRow({fmt::format("  {}", fit.view), std::to_string(fit.board), fit.used ? "yes" : "no",
                  of(fit.printed), of(fit.face), of(fit.edges),
                  fit.used ? Fixed(fit.rms, 2) : "-"});
  }
  return table.Plain();
}

// `inliers` is null if the solver does not report which pairs of this kind it used.
template <class Pair>
std::string DescribeResiduals(const std::vector<Pair>& pairs, const std::vector<double>& residuals,
                              const std::vector<int>* inliers, const char* unit, double scale) {
  if (residuals.empty()) return {};
  if (residuals.size() > kMaxResiduals) {
    return fmt::format("  residuals of {} pairs: see --json\n", residuals.size());
  }
  TextTable table(
      {"  pair", "view", "board", "corner", fmt::format("residual [{}]", unit), "used"});
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const bool used = inliers != nullptr &&
                      std::binary_search(inliers->begin(), inliers->end(), static_cast<int>(i));
    table.AddRow({fmt::format("  {}", i + 1), std::to_string(pairs[i].id.view),
                  std::to_string(pairs[i].id.board), std::to_string(pairs[i].id.corner),
                  fmt::format("{:.2f}", residuals[i] * scale),
                  inliers == nullptr ? "-" : (used ? "yes" : "no")});
  }
  return table.Plain();
}

// The RMSE over the pairs of one kind that the answer is based on, or over all where it is based on
// the other kind or on none.
std::string RmseText(const std::vector<double>& residuals, const std::vector<int>* used,
                     double scale, int decimals) {
  double sum = 0.0;
  std::size_t count = 0;
  const auto add = [&](double residual) {
    if (!std::isfinite(residual)) return;
    sum += residual * residual;
    ++count;
  };
  if (used != nullptr && !used->empty()) {
    for (const int i : *used) add(residuals[static_cast<std::size_t>(i)]);
  } else {
    for (const double residual : residuals) add(residual);
  }
  if (count == 0) return "-";
  return fmt::format("{:.{}f}", scale * std::sqrt(sum / static_cast<double>(count)), decimals);
}

std::string TranslationText(const std::optional<PoseDistance>& distance) {
  return distance ? Fixed(distance->translation_m * kMmPerM, 2) : "-";
}

std::string RotationText(const std::optional<PoseDistance>& distance) {
  return distance ? Fixed(distance->rotation_rad * kDegPerRad, 4) : "-";
}

bool Any(const std::vector<ScoredRow>& rows, bool (*has)(const ScoredRow&)) {
  return std::any_of(rows.begin(), rows.end(), has);
}

constexpr std::size_t kMaxWidth = 100;

std::size_t LongestLine(std::string_view text) {
  std::size_t longest = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    longest = std::max(longest, end);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return longest;
}

/// From the widest table to the narrowest.
enum class PoseColumns {
  kAll,
  kTranslation,
  kNone,
  kErrorsAlone,  ///< No distance to the first, where that to a truth is known.
};

bool HasTranslation(PoseColumns pose) {
  return pose == PoseColumns::kAll || pose == PoseColumns::kTranslation;
}

bool HasRmse(const ScoredRow& of, std::optional<double> Evaluation::*rmse) {
  return of.row.report && (of.row.report->evaluation.*rmse).has_value();
}

/// The columns of a comparison that depend on its rows.
struct ComparisonColumns {
  explicit ComparisonColumns(const std::vector<ScoredRow>& rows)
      : metres(Any(rows, [](const auto& r) { return HasRmse(r, &Evaluation::rmse_m); })),
        pixels(Any(rows, [](const auto& r) { return HasRmse(r, &Evaluation::rmse_px); })),
        truth(Any(rows, [](const auto& r) { return r.row.from_truth.has_value(); })),
        score(Any(rows, [](const auto& r) { return r.score.has_value(); })) {}

  bool HasFirst(PoseColumns pose) const { return !truth || pose != PoseColumns::kErrorsAlone; }

  bool metres;
  bool pixels;
  bool truth;
  bool score;
};

std::vector<std::string> HeaderOf(const ComparisonColumns& columns, PoseColumns pose) {
  std::vector<std::string> header = {"solver"};
  const auto add = [&](bool wanted, std::initializer_list<const char*> names) {
    if (wanted) header.insert(header.end(), names.begin(), names.end());
  };
  add(columns.score, {"score"});
  add(columns.metres, {"RMSE [mm]"});
  add(columns.pixels, {"RMSE [px]"});
  add(true, {"used"});
  add(HasTranslation(pose), {"x [m]", "y [m]", "z [m]"});
  add(pose == PoseColumns::kAll, {"yaw [deg]", "pitch", "roll"});
  add(columns.HasFirst(pose), {"to first [mm]", "[deg]"});
  add(columns.truth, {"error [mm]", "[deg]"});
  add(true, {"time [us]"});
  return header;
}

std::vector<std::string> CellsOf(const ScoredRow& scored, const ComparisonColumns& columns,
                                 PoseColumns pose) {
  const ComparisonRow& row = scored.row;
  const SolveReport& report = *row.report;
  const Evaluation& evaluation = report.evaluation;
  const bool of_points = scored.spec.needs.pairs_3d3d > 0;
  const bool of_pixels = !of_points && scored.spec.needs.pairs_2d3d > 0;
  std::vector<std::string> cells = {report.solver};
  const auto add = [&](bool wanted, std::string cell) {
    if (wanted) cells.push_back(std::move(cell));
  };
  add(columns.score, scored.score ? Fixed(*scored.score, 3) : "-");
  add(columns.metres,
      RmseText(evaluation.per_pair_m, of_points ? &report.inliers : nullptr, kMmPerM, 2));
  add(columns.pixels,
      RmseText(evaluation.per_pair_px, of_pixels ? &report.inliers : nullptr, 1.0, 3));
  const std::size_t of = (of_points ? evaluation.per_pair_m : evaluation.per_pair_px).size();
  const bool knows_kind = of_points || of_pixels;
  add(true, report.inliers.empty() ? "-"
            : knows_kind           ? fmt::format("{}/{}", report.inliers.size(), of)
                                   : std::to_string(report.inliers.size()));
  for (const double v : report.cam_from_lidar.translation) {
    add(HasTranslation(pose), Fixed(v, 4));
  }
  const EulerZyx euler = ToEulerZyx(report.cam_from_lidar.rotation);
  for (const double v : {euler.yaw, euler.pitch, euler.roll}) {
    add(pose == PoseColumns::kAll, Fixed(v * kDegPerRad, 3));
  }
  add(columns.HasFirst(pose), TranslationText(row.from_first));
  add(columns.HasFirst(pose), RotationText(row.from_first));
  add(columns.truth, TranslationText(row.from_truth));
  add(columns.truth, RotationText(row.from_truth));
  add(true, std::isnan(report.wall_time_us) ? "-" : fmt::format("{:.1f}", report.wall_time_us));
  return cells;
}

std::string ComparisonTable(const std::vector<ScoredRow>& rows, PoseColumns pose) {
  const ComparisonColumns columns(rows);
  TextTable table(HeaderOf(columns, pose));
  for (const ScoredRow& scored : rows) {
    if (scored.row.report) table.AddRow(CellsOf(scored, columns, pose));
  }
  return table.Plain(std::string::npos);
}

std::string DescribeAlternatives(const std::vector<Rigid3d>& alternatives) {
  std::string text;
  for (const Rigid3d& other : alternatives) {
    const Eigen::Vector3d& t = other.translation;
    const EulerZyx euler = ToEulerZyx(other.rotation);
    text += fmt::format(
        "  also explains the data     t {:.6f} {:.6f} {:.6f} m, yaw pitch roll {:.4f} {:.4f} "
        "{:.4f} "
        "deg\n",
        t.x(), t.y(), t.z(), euler.yaw * kDegPerRad, euler.pitch * kDegPerRad,
        euler.roll * kDegPerRad);
  }
  return text;
}

}  // namespace

std::string DescribeAnswer(const SolveReport& report) {
  const Evaluation& evaluation = report.evaluation;
  std::string text = report.solver + "\n" + DescribePose(report.cam_from_lidar);
  if (evaluation.rmse_m) {
    text += fmt::format("  RMSE                       {} over {} pairs{}\n",
                        LengthText(*evaluation.rmse_m), evaluation.per_pair_m.size(),
                        RmseOfUsed(report, evaluation.per_pair_m, LengthText));
  }
  if (evaluation.rmse_px) {
    const auto in_px = [](double rmse) { return fmt::format("{:.4f} px", rmse); };
    text +=
        fmt::format("  reprojection RMSE          {} over {} pairs{}\n", in_px(*evaluation.rmse_px),
                    CountProjected(evaluation), RmseOfUsed(report, evaluation.per_pair_px, in_px));
  }
  text += DescribeUncertainty(report);
  text += DescribeNoise(report);
  if (report.camera) text += DescribeNumbers("camera, also estimated", report.camera->estimated);
  if (!report.extras.empty()) text += DescribeNumbers("also estimated", report.extras);
  for (const std::string& warning : report.warnings) {
    text += Narrow("  note: " + warning);
  }
  text += fmt::format("  {}, {} iterations, {:.1f} us\n", ToString(report.termination),
                      report.iterations, report.wall_time_us);
  text += DescribeAlternatives(report.alternatives);
  return text;
}

std::string DescribeReport(const CalibrationProblem& problem, const SolverSpec& spec,
                           const SolveReport& report) {
  const Evaluation& evaluation = report.evaluation;
  std::string text = DescribeAnswer(report);
  if (!report.board_views.empty()) text += DescribeBoardViews(report.board_views);
  // The inliers are indices into pairs of one kind only; see Estimate.
  const bool of_points = spec.needs.pairs_3d3d > 0;
  const std::vector<int>* point_inliers = of_points ? &report.inliers : nullptr;
  const std::vector<int>* pixel_inliers =
      !of_points && spec.needs.pairs_2d3d > 0 ? &report.inliers : nullptr;
  text +=
      DescribeResiduals(problem.pairs_3d3d, evaluation.per_pair_m, point_inliers, "mm", kMmPerM);
  text += DescribeResiduals(problem.pairs_2d3d, evaluation.per_pair_px, pixel_inliers, "px", 1.0);
  return text;
}

std::string DescribeComparison(const std::vector<ScoredRow>& rows) {
  // The most of the pose that leaves lines short enough for a terminal; --json has all of it.
  std::string table;
  for (const PoseColumns pose : {PoseColumns::kAll, PoseColumns::kTranslation, PoseColumns::kNone,
                                 PoseColumns::kErrorsAlone}) {
    table = ComparisonTable(rows, pose);
    if (LongestLine(table) <= kMaxWidth) break;
  }
  TextTable failures({"no answer of", "because"}, TextTable::Columns::kWords);
  bool any_failure = false;
  for (const ScoredRow& scored : rows) {
    if (scored.row.report) continue;
    failures.AddRow({scored.row.solver, scored.row.report.error().message});
    any_failure = true;
  }
  std::string text = table;
  // The best answer shows them, as under `solve`; a pose of another program has none.
  const auto best = std::ranges::find_if(rows, [](const ScoredRow& scored) {
    return scored.row.report && !scored.row.report->inliers.empty();
  });
  if (best != rows.end() && !best->row.report->alternatives.empty()) {
    text += Narrow(fmt::format("\nThe answer of {} is not the only one:\n", best->row.solver)) +
            DescribeAlternatives(best->row.report->alternatives);
  }
  return any_failure ? text + "\n" + failures.Plain(kMaxWidth) : text;
}

std::string DescribeComparison(const std::vector<ComparisonRow>& rows) {
  std::vector<ScoredRow> unscored;
  for (const ComparisonRow& row : rows) unscored.push_back({.row = row});
  return DescribeComparison(unscored);
}

}  // namespace sextant
