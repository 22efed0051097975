// SPDX-License-Identifier: Apache-2.0
#include "report/collect/collect_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "calibrate/trust/information.h"
#include "eval/statistics/text_table.h"
#include "report/collect/no_pose.h"
#include "report/collect/page_inputs.h"
#include "report/collect/page_next.h"
#include "report/collect/page_plots.h"
#include "report/collect/page_tables.h"
#include "report/collect/page_views.h"
#include "report/collect/pose_in_words.h"
#include "report/collect/utc_text.h"

namespace sextant {
namespace {

PageVerdict VerdictOf(const CalibrationResult& result) {
  if (!result.verdict) {
    return {.word = "NO VERDICT",
            .reason = "The result file was written by a version without verdicts",
            .next = "Calibrate again"};
  }
  PageTone tone = PageTone::kBad;
  if (result.verdict->usability == Usability::kGood) tone = PageTone::kGood;
  if (result.verdict->usability == Usability::kUsableWithCare) tone = PageTone::kCaution;
  return {.tone = tone,
          .word = std::string(ToString(result.verdict->usability)),
          .reason = result.verdict->reason,
          .next = result.verdict->next};
}

std::optional<double> RmsOf(const std::vector<ResultView>& views,
                            std::vector<double> ResultBoardView::*residuals) {
  double squares = 0.0;
  int count = 0;
  for (const ResultView& view : views) {
    for (const ResultBoardView& board : view.boards) {
      for (const double residual : board.*residuals) {
        if (!view.kept || !std::isfinite(residual)) continue;
        squares += residual * residual;
        ++count;
      }
    }
  }
  if (count == 0) return std::nullopt;
  return std::sqrt(squares / count);
}

std::string InMm(const std::optional<double>& metres) {
  return metres ? Fixed(1e3 * *metres, 1) + " mm" : "–";
}

void AddSigmaFigures(const CalibrationResult& result, std::vector<PageFigure>& figures) {
  if (!result.covariance) {
    figures.push_back({"1 sigma", "unknown", "the data is not redundant"});
    return;
  }
  const WeakestDirections weakest = WeakestOf(*result.covariance);
  figures.push_back({"Translation, 1 sigma", InMm(weakest.translation_sigma_m),
                     "least certain: " + AxisName(weakest.translation_axis_in_cam)});
  figures.push_back({"Rotation, 1 sigma",
                     Fixed(kDegPerRad * weakest.rotation_sigma_rad, 3) + " deg",
                     "least certain: about " + AxisName(weakest.rotation_axis_in_cam)});
}

std::vector<PageFigure> FiguresFor(const CalibrationResult& result) {
  std::vector<PageFigure> figures;
  AddSigmaFigures(result, figures);
  const auto px = RmsOf(result.views, &ResultBoardView::residuals_px);
  const std::string in_px = px ? fmt::format("; {:.2f} px in the photos", *px) : "";
  figures.push_back({"Corners of the two sensors, RMS",
                     InMm(RmsOf(result.views, &ResultBoardView::residuals_m)),
                     "under the result" + in_px});
  if (result.trust && result.trust->held_out_rmse_m) {
    figures.push_back({"Held-out corners, RMS", InMm(result.trust->held_out_rmse_m),
                       "each under the result of the other views"});
  }
  const auto kept = std::count_if(result.views.begin(), result.views.end(),
                                  [](const ResultView& view) { return view.kept; });
  figures.push_back(
      {"Views", fmt::format("{} of {}", kept, result.views.size()), "used, of those recorded"});
  return figures;
}

std::string DateOf(const PageSource& source) {
  std::optional<double> first;
  std::optional<double> last;
  for (const ResultView& view : source.result.views) {
    if (!view.image_time_s) continue;
    first = first ? std::min(*first, *view.image_time_s) : *view.image_time_s;
    last = last ? std::max(*last, *view.image_time_s) : *view.image_time_s;
  }
  std::string text;
  if (first && !UtcText(*first).empty()) {
    text = fmt::format("Recorded {} to {}", UtcText(*first), UtcText(*last));
  }
  if (source.written.empty()) return text;
  return text + (text.empty() ? "" : " · ") + "report of " + source.written;
}

std::vector<PageTransform> TransformsOf(const CalibrationResult& result) {
  PageTransform transform{.from = result.lidar_frame,
                          .to = result.camera_frame,
                          .to_from_from = result.cam_from_lidar,
                          .in_words = PoseInWords(result.cam_from_lidar)};
  if (result.covariance) transform.sigma = result.covariance->diagonal().cwiseSqrt();
  return {transform};
}

}  // namespace

ReportPage CollectPage(const PageSource& source) {
  const CalibrationResult& result = source.result;
  ReportPage page{
      .title = fmt::format("{} and {}", result.camera_frame, result.lidar_frame),
      .date = DateOf(source),
      .version = result.version,
      .verdict = VerdictOf(result),
      .figures = FiguresFor(result),
      .transforms = TransformsOf(result),
      .sensors = PageSensorsOf(result),
      .views = PageViewsOf(result, source.calibration, source.frames),
      .coverage = CoverageOf(result),
      .coverage_plots = CoveragePlots(result),
      .residual_plots = ResidualPlots(result),
      .sigma_plots = SigmaPlots(result),
      .sigmas = SigmaTable(result),
      .correlation = CorrelationOf(result),
      .noise = NoiseTable(result, source.calibration),
      .comparison = source.compares_solvers ? ComparisonTable(source.calibration) : PageTable{},
      .diagnostics = result.warnings,
      .next = NextOf(result),
      .closing = result.closing,
      .inputs = InputsOf(result, source.calibration, source.folder),
      .configuration = result.configuration};
  if (result.trust) page.sigma_text = result.trust->comparison;
  if (!result.solver.empty()) {
    page.configuration.insert(page.configuration.begin(), "solver: " + result.solver);
  }
  if (source.calibration != nullptr && !source.calibration->result) DropWhatNeedsThePose(page);
  return page;
}

}  // namespace sextant
