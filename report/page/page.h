// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/rigid3d.h"

namespace sextant {

// The content of a report in HTML, without its layout: what a calibration, a rig or a check shows
// to somebody who did not run the program. Texts may be anybody's; the writer escapes them. Poses
// and points are in the frame of the first LiDAR, called base (x forward, y left, z up) [m].

/// How a verdict is shown; its word is always written, too.
enum class PageTone { kGood, kCaution, kBad, kNeutral };

struct PageVerdict {
  PageTone tone = PageTone::kNeutral;
  std::string word{};    ///< "GOOD".
  std::string reason{};  ///< One sentence, without its full stop.
  std::string next{};    ///< What to do next; the same.
};

/// A figure at the top of the page: "Translation", "2.1 mm", "1 sigma of the weakest direction".
struct PageFigure {
  std::string label{};
  std::string value{};
  std::string note{};
};

/// A table of texts. Columns after the first `words` hold numbers and are flush right.
struct PageTable {
  std::vector<std::string> header{};
  std::vector<std::vector<std::string>> rows{};
  std::size_t words = 1;
  std::string note{};  ///< Below the table; or, without rows, why there is none.
};

/// A transform between two frames, which the page shows in both directions.
struct PageTransform {
  std::string from{};  ///< Such as "lidar".
  std::string to{};    ///< Such as "camera".
  Rigid3d to_from_from{};
  std::string in_words{};
  /// 1 sigma of (dphi [rad], dt [m]) in the frame `to`.
  std::optional<Vector6d> sigma{};
};

struct PageSensor {
  std::string name{};
  bool is_camera = false;
  PageTable facts{};                          ///< Name and value.
  std::optional<Rigid3d> base_from_sensor{};  ///< None while its pose is unknown.
  /// Camera: points 0.5 m away on the rays of the image's outline, clockwise from the top left, as
  /// many on each side; in its own frame.
  std::vector<Eigen::Vector3d> frustum{};
};

/// Returns of one scan, at most a few thousand. The vectors are as long as `in_base`, or empty.
struct PageScan {
  std::vector<Eigen::Vector3f> in_base{};
  std::vector<std::uint8_t> intensity{};              ///< 0 to 255: 2nd to 98th percentile.
  std::vector<std::array<std::uint8_t, 3>> colour{};  ///< R, G, B; grey outside the photo.
  int returns = 0;                                    ///< Number in the whole scan.
};

/// A return in a photo.
struct PageDot {
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
  float nearness = 0.0F;  ///< 0 far to 1 near, on the logarithmic scale of the ranges below.
};

/// A photo with the scan over it. Pixels are those of the camera model, whatever the JPEG's size.
struct PagePhoto {
  std::string jpeg{};
  int width_px = 0;
  int height_px = 0;
  std::vector<PageDot> dots{};  ///< From far to near.
  double nearest_m = 0.0;
  double farthest_m = 0.0;
};

/// A board in one view. Outlines are empty where a sensor has no pose of its own.
struct PageBoard {
  std::string name{};
  std::vector<Eigen::Vector3d> by_camera{};     ///< Its four corners in the base frame.
  std::vector<Eigen::Vector3d> by_lidar{};      ///< The same.
  std::vector<Eigen::Vector2d> camera_in_px{};  ///< Closed outlines in the photo, with the lens.
  std::vector<Eigen::Vector2d> lidar_in_px{};
  std::vector<double> residuals_m{};   ///< One for each corner; infinite if it does not project.
  std::vector<double> residuals_px{};  ///< The same.
  double range_m = 0.0;
};

struct PageView {
  std::string name{};
  bool is_kept = true;
  std::string reason{};  ///< Why it was left out; or empty.
  std::string time{};    ///< When it was recorded; empty if unknown.
  std::optional<double> rmse_m{};
  std::optional<double> rmse_px{};
  std::optional<double> held_out_m{};
  std::optional<Vector6d> sigma_so_far{};  ///< (dphi [rad], dt [m]) with all views up to it.
  std::vector<PageBoard> boards{};
  std::optional<PagePhoto> photo{};
  std::optional<PageScan> scan{};
  std::string no_photo{};  ///< Why photo or scan are absent.
};

/// Points of one kind in a plot.
struct PageSeries {
  std::string name{};
  std::vector<Eigen::Vector2d> points{};
  bool is_line = false;
};

struct PagePlot {
  std::string title{};
  std::string x_label{};
  std::string y_label{};
  std::vector<PageSeries> series{};  ///< At most four.
  bool is_log_y = false;
  std::string note{};  ///< What to look for.
};

/// Where in a camera's image the boards were.
struct PageCoverage {
  std::string camera{};
  int width_px = 0;
  int height_px = 0;
  std::vector<std::vector<Eigen::Vector2d>> outlines{};
  double share = 0.0;  ///< Share of the image's cells that a board has touched.
};

/// Correlations, -1 to 1.
struct PageCorrelation {
  std::vector<std::string> names{};
  Eigen::MatrixXd values{};
};

/// What the result rests on.
struct PageInputs {
  PageTable files{};
  std::string hash{};  ///< SHA-256 over those of the files; empty without files.
};

/// Where to hold a board next.
struct PageNext {
  std::vector<std::string> sentences{};
  std::string png{};  ///< A picture; empty: none.
};

/// A part under a heading of its own, which only some pages have.
struct PageSection {
  std::string id{};  ///< For links within the page: letters alone.
  std::string title{};
  std::string label{};  ///< Its name in the contents.
  std::vector<std::string> sentences{};
  PageTable table{};
};

/// What the page of a capture shows while it runs.
struct PageLive {
  std::string revision{};            ///< Differs whenever the page does; the browser compares it.
  std::string state{};               ///< "Waiting for the next photo and scan".
  bool has_ended = false;            ///< The page does not change any more.
  std::vector<std::string> found{};  ///< What each sensor saw, the newest first.
};

struct ReportPage {
  std::string kind = "Calibration report";  ///< Above the title.
  std::string title{};
  std::string date{};     ///< The only text that is not a function of the inputs.
  std::string version{};  ///< The version of the program.
  PageVerdict verdict{};
  std::vector<PageFigure> figures{};
  std::vector<PageTransform> transforms{};
  std::vector<PageSensor> sensors{};
  std::vector<PageSection> sections{};  ///< Before the views.
  std::vector<PageView> views{};
  /// The view that is shown first; none: the first that was kept.
  std::optional<std::size_t> selected{};
  std::vector<PageCoverage> coverage{};
  std::vector<PagePlot> coverage_plots{};
  std::vector<PagePlot> residual_plots{};
  std::vector<PagePlot> sigma_plots{};
  PageTable sigmas{};  ///< 1 sigma of each unknown by each method.
  std::string sigma_text{};
  std::optional<PageCorrelation> correlation{};
  PageTable noise{};       ///< Noise levels, and nuisance parameters with their priors.
  PageTable comparison{};  ///< Solvers on the same data.
  std::vector<std::string> diagnostics{};
  PageNext next{};
  std::string closing{};
  PageInputs inputs{};
  std::vector<std::string> configuration{};
  std::optional<PageLive> live{};  ///< Only while a capture runs.
};

}  // namespace sextant
