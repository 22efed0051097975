// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/diagnose.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "calibrate/trust/measured_boards.h"
#include "calibrate/trust/scale_fit.h"

namespace sextant {
namespace {

constexpr double kMinExcess = 0.01;  // Relative to a distance.
constexpr double kSigmas = 4.0;
constexpr double kPoorPrint_px = 1.0;  // RMS; a good lens model leaves a third of it.
constexpr double kPoorPrint = 3.0;     // RMS over the stated noise.
constexpr double kSamePlace_m = 0.05;
constexpr double kSameTurn_rad = 5.0 * std::numbers::pi / 180.0;

void DiagnoseScale(const CalibrationProblem& problem, const Rigid3d& pose,
                   std::vector<std::string>& lines) {
  const std::optional<ScaleFits> fits = FitScales(problem, pose);
  if (!fits) return;
  const bool is_print = fits->IsPrint();
  const ScaleFit& fit = fits->Better();
  if (std::abs(fit.excess) < std::max(kMinExcess, kSigmas * fit.sigma)) return;
  const double percent = 100.0 * std::abs(fit.excess);
  const char* sign = fit.excess > 0.0 ? "longer" : "shorter";
  // A print of 0.9 times its stated size appears 1 / 0.9 times as far away.
  const char* size = fit.excess > 0.0 ? "smaller" : "larger";
  const char* focal = fit.excess > 0.0 ? "long" : "short";
  lines.push_back(
      is_print
          ? fmt::format("board file: distances in the images are {:.1f} percent {} than in the "
                        "scans, in all directions (1 sigma {:.1f}): the print is {} than the "
                        "board file states, or the focal length is wrong; measure the print",
                        percent, sign, 100.0 * fit.sigma, size)
          : fmt::format("intrinsics: boards are {:.1f} percent {} away in the images than in the "
                        "scans, in depth only (1 sigma {:.1f}): the focal length is too {}, or the "
                        "print does not have the size in the board file",
                        percent, fit.excess > 0.0 ? "further" : "less far", 100.0 * fit.sigma,
                        focal));
}

void DiagnosePrints(std::span<const SessionView> views, const Assembly& assembly,
                    std::vector<std::string>& lines) {
  const std::optional<PrintFit> fit = MeasurePrints(views, assembly);
  if (!fit || fit->rms_px < kPoorPrint_px || fit->over_noise < kPoorPrint) return;
  lines.push_back(
      fmt::format("intrinsics: the prints fit the camera model only to {:.1f} px, {:.0f} times "
                  "their noise: the intrinsics do not describe the lens, or a print is not flat",
                  fit->rms_px, fit->over_noise));
}

void DiagnoseSession(const Assembly& assembly, std::vector<std::string>& lines) {
  const std::vector<BoardView>& boards = assembly.problem.board_views;
  std::set<int> views;
  for (const BoardView& board : boards) views.insert(board.view);
  if (views.size() == 1) {
    lines.emplace_back(
        "one view only: it cannot be compared with another, so an error in it would not be "
        "noticed");
    return;
  }
  std::map<int, const BoardView*> first;
  for (const BoardView& board : boards) {
    const auto [entry, is_first] = first.try_emplace(board.board, &board);
    if (is_first) continue;
    const PoseDistance moved = DistanceBetween(entry->second->cam_from_board, board.cam_from_board);
    if (moved.translation_m > kSamePlace_m || moved.rotation_rad > kSameTurn_rad) return;
  }
  lines.push_back(
      fmt::format("all {} views are the same: every board stays within {:.0f} cm and {:.0f} deg of "
                  "one place; together they contribute little more than one view. Move the boards",
                  views.size(), 100.0 * kSamePlace_m, kSameTurn_rad * 180.0 / std::numbers::pi));
}

// "3, 4 and 2 more", by the views' names.
std::string NamesOf(std::span<const SessionView> views, const std::vector<int>& indices) {
  constexpr std::size_t kMaxNamed = 6;
  std::string text;
  for (std::size_t i = 0; i < std::min(indices.size(), kMaxNamed); ++i) {
    const std::string& name = views[static_cast<std::size_t>(indices[i])].name;
    text +=
        fmt::format("{}{}", i == 0 ? "" : ", ", name.empty() ? std::to_string(indices[i]) : name);
  }
  if (indices.size() <= kMaxNamed) return text;
  return text + fmt::format(" and {} more", indices.size() - kMaxNamed);
}

void DiagnoseRepeats(std::span<const SessionView> views, const Assembly& assembly,
                     std::vector<std::string>& lines) {
  std::vector<int> copies;
  for (const BoardRow& row : assembly.rows) {
    if (row.fate == BoardStatus::kCopy) copies.push_back(static_cast<int>(row.view));
  }
  if (!copies.empty()) {
    lines.push_back(
        fmt::format("copies: view{} {} left out, because image and scan are those of an earlier "
                    "view; a copy adds nothing",
                    copies.size() == 1 ? "" : "s",
                    NamesOf(views, copies) + (copies.size() == 1 ? " is" : " are")));
  }
  for (const RepeatedPlacement& placement : assembly.repeated) {
    lines.push_back(fmt::format(
        "repeated: views {} show board {} in one place; they share its errors, so that they count "
        "as one view in the covariance. Move the board between views",
        NamesOf(views, placement.views),
        assembly.problem.boards[static_cast<std::size_t>(placement.board)].id));
  }
}

}  // namespace

std::vector<std::string> Diagnose(std::span<const SessionView> views, const Assembly& assembly,
                                  const Rigid3d& cam_from_lidar) {
  std::vector<std::string> lines;
  DiagnoseSession(assembly, lines);
  DiagnoseRepeats(views, assembly, lines);
  for (std::string& line : DescribeEdges(MeasureEdges(views, assembly), assembly)) {
    lines.push_back(std::move(line));
  }
  DiagnoseScale(assembly.problem, cam_from_lidar, lines);
  DiagnosePrints(views, assembly, lines);
  return lines;
}

}  // namespace sextant
