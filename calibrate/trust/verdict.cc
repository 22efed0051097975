// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/verdict.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/units.h"

namespace sextant {
namespace {

// From which value on a figure allows use with care only, and from which on no use.
struct Limit {
  double care;
  double no_use;

  Usability Of(double value) const {
    if (!(value < no_use)) return Usability::kNotUsable;
    return value < care ? Usability::kGood : Usability::kUsableWithCare;
  }
};

// The table of docs/formats.md.
constexpr Limit kOverNeed = {1.0, 10.0};
constexpr Limit kUnusedShare = {0.2, 0.5};
constexpr Limit kContradictingShare = {0.1, 0.34};
constexpr Limit kOutlierShare = {0.1, 0.34};
constexpr Limit kSpreadOverSolver = {3.0, 15.0};
constexpr Limit kHeldOutExcess = {1.5, 4.0};
constexpr Limit kHalvesOff = {3.0, 5.0};  // Sigmas.
constexpr Limit kCornerRms_m = {0.03, 0.1};
constexpr Limit kRangeExcess = {0.006, 0.014};
constexpr Limit kSizeExcess = {0.015, 0.05};
constexpr Limit kNormalsOff_rad = {2.5 * kRadPerDeg, 6.0 * kRadPerDeg};
constexpr Limit kPrintRms_px = {1.0, 4.0};
constexpr double kMinPrintOverNoise = 3.0;
constexpr double kRoughMargin_rad = 45.0 * kRadPerDeg;
constexpr double kAssumedMargin_rad = 120.0 * kRadPerDeg;
constexpr double kSignificant = 3.0;  // Sigmas.

class Judge {
 public:
  Judge(const VerdictFigures& figures, const AccuracyNeed& need) : f_(figures), need_(need) {}

  ResultVerdict Verdict() {
    Rivals();
    Ranges();
    Sizes();
    Prints();
    Views();
    Halves();
    Normals();
    Corners();
    Number();
    Consistency();
    Accuracy();
    if (verdict_.usability == Usability::kGood) {
      verdict_.reason = GoodReason();
      verdict_.next = "Check it once by eye with sextant project, then export it";
    }
    return verdict_;
  }

 private:
  // Takes the rule's text if it is worse than every rule before it.
  void Add(Usability usability, std::string reason, std::string next) {
    if (usability <= verdict_.usability) return;
    verdict_ = {usability, std::move(reason), std::move(next)};
  }

  void Rivals() {
    if (f_.rival_poses == 0) return;
    const double needed_rad = f_.has_rough_pose ? kRoughMargin_rad : kAssumedMargin_rad;
    const bool one = f_.rival_poses == 1;
    Add(f_.rival_margin_rad < needed_rad ? Usability::kNotUsable : Usability::kUsableWithCare,
        fmt::format("{} other pose{} explain{} the views as well, and only {} chose this one",
                    f_.rival_poses, one ? "" : "s", one ? "s" : "",
                    f_.has_rough_pose
                        ? "the rough pose of --initial"
                        : "the assumption of an upright camera along the LiDAR's x axis"),
        f_.has_rough_pose ? "Add views with the board in other places and tilts"
                          : "Add views with the board in other places and tilts, or give a rough "
                            "pose with --initial");
  }

  void Views() {
    if (f_.views_with_board == 0) return;
    const double all = f_.views_with_board;
    Add(kContradictingShare.Of(f_.views_contradicting / all),
        fmt::format("In {} of {} views the photo and the scan contradict each other or the other "
                    "views",
                    f_.views_contradicting, f_.views_with_board),
        "Check that each photo and its scan are of one moment, with every board at rest, and "
        "record "
        "those views again");
    Add(kOutlierShare.Of(f_.outlier_views / std::max(1.0, static_cast<double>(f_.views_used))),
        fmt::format("{} of {} used views disagree with the answer of the others", f_.outlier_views,
                    f_.views_used),
        "Remove or record again the views named in the diagnostics");
    Add(kUnusedShare.Of(1.0 - f_.views_used / all - 1e-9),
        fmt::format("Only {} of the {} views whose photo shows a board could be used",
                    f_.views_used, f_.views_with_board),
        "See the reasons under the table, and hold the board where more rings cross it");
  }

  void Halves() {
    if (!f_.halves_off) return;
    Add(kHalvesOff.Of(*f_.halves_off),
        fmt::format("The first and the second half of the views give different poses, by {:.0f} "
                    "sigma",
                    *f_.halves_off),
        "Check whether a sensor moved between the views, and calibrate the views before and after "
        "separately");
  }

  void Ranges() {
    if (!f_.range_excess) return;
    const double size = std::abs(*f_.range_excess);
    if (size < kSignificant * f_.range_excess_sigma) return UnclearRanges(size);
    Add(kRangeExcess.Of(size),
        fmt::format("Boards are {:.1f} percent {} in the images than in the scans (1 sigma {:.1f})",
                    100.0 * size, *f_.range_excess > 0.0 ? "farther away" : "nearer",
                    100.0 * f_.range_excess_sigma),
        "Measure the print and compare it with the board file, and check the focal length");
  }

  // An excess that would matter, if it were certain, is no reason for trust either.
  void UnclearRanges(double size) {
    if (size < kRangeExcess.no_use) return;
    Add(Usability::kUsableWithCare,
        fmt::format("Boards may be {:.1f} percent {} in the images than in the scans (1 sigma "
                    "{:.1f}); these views do not determine it",
                    100.0 * size, *f_.range_excess > 0.0 ? "farther away" : "nearer",
                    100.0 * f_.range_excess_sigma),
        "Add views with the board at other distances, and check the focal length and the size of "
        "the print");
  }

  void Sizes() {
    if (!f_.size_excess) return;
    Add(kSizeExcess.Of(std::abs(*f_.size_excess)),
        fmt::format("A board is {:.1f} percent {} in the scans than in the board file",
                    100.0 * std::abs(*f_.size_excess),
                    *f_.size_excess > 0.0 ? "larger" : "smaller"),
        "Measure the board and correct the board file");
  }

  void Normals() {
    if (!f_.normals_off_rad) return;
    Add(kNormalsOff_rad.Of(*f_.normals_off_rad),
        fmt::format("The two sensors see the boards tilted {:.1f} deg from each other (median)",
                    *f_.normals_off_rad * kDegPerRad),
        "Check the camera file and the board file, and that the boards are flat");
  }

  void Prints() {
    if (!f_.print_rms_px || !f_.print_over_noise) return;
    if (*f_.print_over_noise < kMinPrintOverNoise) return;
    Add(kPrintRms_px.Of(*f_.print_rms_px),
        fmt::format("The prints fit the camera model only to {:.1f} px, {:.0f} times their noise",
                    *f_.print_rms_px, *f_.print_over_noise),
        "Calibrate the camera again with the right lens model, and check that the print is flat "
        "and "
        "of the size in the board file");
  }

  void Corners() {
    if (!f_.corner_rms_m) return;
    Add(kCornerRms_m.Of(*f_.corner_rms_m),
        fmt::format("The corners by the two sensors are {:.0f} mm apart (RMS)",
                    1e3 * *f_.corner_rms_m),
        "Look at the worst views with sextant project; check the board file and the camera file");
  }

  void Consistency() {
    if (!f_.is_checked) return;
    if (f_.held_out_over_fit && f_.independent_views > 2) {
      // With equal views and noise alone the mean squares differ by (n + 1) / (n - 1).
      const double n = f_.independent_views;
      Add(kHeldOutExcess.Of(*f_.held_out_over_fit / std::sqrt((n + 1.0) / (n - 1.0))),
          fmt::format("Held-out views fit the answer {:.1f} times worse than those in it",
                      *f_.held_out_over_fit),
          "Add views with the board in other places and tilts");
    }
    if (f_.spread_over_solver) {
      Add(kSpreadOverSolver.Of(*f_.spread_over_solver),
          fmt::format("The views differ from each other {:.1f} times as much as their noise "
                      "explains; the stated figures include that",
                      *f_.spread_over_solver),
          "Check the board's size, the intrinsics and the views with the largest residuals");
    }
  }

  void Number() {
    const int n = f_.independent_views;
    if (n < kMinViewsForGood) {
      Add(Usability::kUsableWithCare,
          n == 1 ? std::string("One view only: nothing shows whether it is right")
                 : fmt::format("{} views with the board in different places are too few to single "
                               "out a wrong one",
                               n),
          fmt::format("Add {} or more views with the board in other places and tilts",
                      std::max(1, 6 - n)));
    }
    if (f_.is_checked) return;
    Add(Usability::kUsableWithCare, "The views were not compared with each other (--bootstrap 0)",
        "Run it again with --bootstrap 100");
  }

  void Accuracy() {
    if (!f_.worst_translation_m || !f_.worst_rotation_rad) {
      Add(Usability::kNotUsable, "How certain the answer is cannot be computed from this data",
          "Add views with the board in other places and tilts");
      return;
    }
    const double over = std::max(*f_.worst_translation_m / need_.translation_m,
                                 *f_.worst_rotation_rad / need_.rotation_rad);
    Add(kOverNeed.Of(over),
        fmt::format("The least certain direction is known to {}, and {} are needed", WorstText(),
                    NeedText()),
        "Add views where sextant advise proposes them");
  }

  std::string WorstText() const {
    return fmt::format("{:.3g} mm and {:.3g} deg", 1e3 * *f_.worst_translation_m,
                       *f_.worst_rotation_rad * kDegPerRad);
  }

  std::string NeedText() const {
    return fmt::format("{:g} mm and {:g} deg", 1e3 * need_.translation_m,
                       need_.rotation_rad * kDegPerRad);
  }

  std::string GoodReason() const {
    return fmt::format(
        "{} of {} views agree, and the least certain direction is known to {} of the {} needed",
        f_.views_used - f_.outlier_views, f_.views_with_board, WorstText(), NeedText());
  }

  const VerdictFigures& f_;
  const AccuracyNeed& need_;
  ResultVerdict verdict_{.usability = Usability::kGood};
};

}  // namespace

ResultVerdict JudgeResult(const VerdictFigures& figures, const AccuracyNeed& need) {
  return Judge(figures, need).Verdict();
}

}  // namespace sextant
