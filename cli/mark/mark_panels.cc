// SPDX-License-Identifier: Apache-2.0
#include "cli/mark/mark_panels.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

namespace sextant::cli {
namespace {

const cv::Scalar kText(235, 235, 235);
const cv::Scalar kDim(170, 170, 170);
const cv::Scalar kMessage(120, 220, 255);
const cv::Scalar kWarning(90, 150, 255);
const cv::Scalar kBar(45, 40, 38);
constexpr double kTextSize = 0.5;

// Keys and their effect; a line without keys spans both columns.
struct HelpLine {
  const char* keys;
  const char* text;
};
constexpr std::array kHelp = {
    HelpLine{"", "Draw an area of four clicks around each edge of a board, so that"},
    HelpLine{"", "it contains the ends of the rings on it: top-left edge first,"},
    HelpLine{"", "then clockwise; boards from left to right."},
    HelpLine{"", ""},
    HelpLine{"left click", "mark"},
    HelpLine{"right click, u", "undo"},
    HelpLine{"r", "redo"},
    HelpLine{"n, b", "next board, previous board"},
    HelpLine{"d", "delete board"},
    HelpLine{"e, c", "edges in the scan, corners in the photo"},
    HelpLine{"wheel, + -", "zoom"},
    HelpLine{"f", "whole picture"},
    HelpLine{"drag, arrows", "move the picture"},
    HelpLine{"v", "scan and photo, scan, photo"},
    HelpLine{"s", "save"},
    HelpLine{"q", "quit"},
    HelpLine{"h", "this help"},
};

const std::array<cv::Vec3b, 256>& Turbo() {
  static const std::array<cv::Vec3b, 256> table = [] {
    cv::Mat levels(1, 256, CV_8U);
    for (int i = 0; i < 256; ++i) levels.at<unsigned char>(0, i) = static_cast<unsigned char>(i);
    cv::Mat colors;
    cv::applyColorMap(levels, colors, cv::COLORMAP_TURBO);
    std::array<cv::Vec3b, 256> result;
    for (int i = 0; i < 256; ++i) result[static_cast<std::size_t>(i)] = colors.at<cv::Vec3b>(0, i);
    return result;
  }();
  return table;
}

int WidthOf(const std::string& text) {
  int baseline = 0;
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, kTextSize, 1, &baseline).width;
}

void Text(cv::Mat& canvas, const std::string& text, int x, int y, const cv::Scalar& color) {
  cv::putText(canvas, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, kTextSize, color, 1, cv::LINE_AA);
}

void Shade(cv::Mat& canvas, cv::Rect where) {
  where &= cv::Rect(0, 0, canvas.cols, canvas.rows);
  if (where.empty()) return;
  cv::Mat part = canvas(where);
  cv::addWeighted(part, 0.08, cv::Mat(part.size(), part.type(), kBar), 0.92, 0.0, part);
}

void DrawLegend(const RangeColors& colors, int bar_px, cv::Mat& canvas) {
  constexpr int kWidth = 12;
  constexpr int kHeight = 160;
  const int x = canvas.cols - 62;
  const int y = bar_px + 26;
  Shade(canvas, {x - 12, y - 22, 70, kHeight + 44});
  for (int i = 0; i < kHeight; ++i) {
    const double range = colors.near_m() + (colors.far_m() - colors.near_m()) * i / (kHeight - 1.0);
    cv::line(canvas, {x, y + i}, {x + kWidth, y + i}, colors.Of(range), 1);
  }
  Text(canvas, fmt::format("{:.1f}", colors.near_m()), x + kWidth + 5, y + 6, kText);
  Text(canvas, fmt::format("{:.1f}", colors.far_m()), x + kWidth + 5, y + kHeight, kText);
  Text(canvas, "m", x + kWidth + 5, y + kHeight / 2, kDim);
}

void DrawHelp(cv::Mat& canvas) {
  constexpr int kLine = 22;
  constexpr int kColumn = 140;
  int widest = 0;
  for (const HelpLine& line : kHelp) {
    const int indent = *line.keys != '\0' ? kColumn : 0;
    widest = std::max(widest, indent + WidthOf(line.text));
  }
  const int height = kLine * static_cast<int>(kHelp.size()) + 24;
  const int x = (canvas.cols - widest) / 2;
  int y = (canvas.rows - height) / 2;
  Shade(canvas, {x - 20, y, widest + 40, height});
  for (const HelpLine& line : kHelp) {
    y += kLine;
    Text(canvas, line.keys, x, y, kMessage);
    Text(canvas, line.text, *line.keys != '\0' ? x + kColumn : x, y, kText);
  }
}

void DrawWarnings(const std::vector<std::string>& warnings, int bar_px, cv::Mat& canvas) {
  int y = canvas.rows - bar_px - 10;
  for (const std::string& warning : warnings) {
    Shade(canvas, {8, y - 16, WidthOf(warning) + 16, 22});
    Text(canvas, warning, 16, y, kWarning);
    y -= 24;
  }
}

}  // namespace

RangeColors::RangeColors(const std::vector<ProjectedReturn>& returns) {
  if (returns.empty()) return;
  std::vector<double> ranges;
  for (const ProjectedReturn& r : returns) ranges.push_back(r.range_m);
  std::ranges::sort(ranges);
  near_m_ = ranges[ranges.size() / 50];
  far_m_ = std::max(ranges[ranges.size() - 1 - ranges.size() / 50], near_m_ + 0.1);
}

cv::Scalar RangeColors::Of(double range_m) const {
  // Logarithmic, to spend more colours on the near ranges, where the boards are.
  const double share = std::log(std::max(range_m, 0.01) / near_m_) / std::log(far_m_ / near_m_);
  const double level = 245.0 - 225.0 * std::clamp(near_m_ > 0.0 ? share : 0.0, 0.0, 1.0);
  const cv::Vec3b& color = Turbo()[static_cast<std::size_t>(level)];
  return {static_cast<double>(color[0]), static_cast<double>(color[1]),
          static_cast<double>(color[2])};
}

void DrawMarkPanels(const MarkController& controller, bool has_photo, int bar_px, cv::Mat& canvas) {
  Shade(canvas, {0, 0, canvas.cols, bar_px});
  Shade(canvas, {0, canvas.rows - bar_px, canvas.cols, bar_px});
  const MarkSession& session = controller.session();
  Text(canvas, session.Prompt(), 12, bar_px - 12, kText);
  const std::string& message = controller.message();
  Text(canvas, message, canvas.cols - 12 - WidthOf(message), bar_px - 12, kMessage);
  const std::string keys = fmt::format(
      "click: mark    right click: undo    wheel: zoom    drag: move    n/b: board    d: delete    "
      "{}s: save    q: quit    h: help",
      has_photo ? "e/c: edges/corners    v: view    " : "");
  Text(canvas, keys, 12, canvas.rows - 12, kDim);
  DrawWarnings(session.Warnings(), bar_px, canvas);
  if (controller.layers() != MarkLayers::kPhoto && !session.returns().empty()) {
    DrawLegend(RangeColors(session.returns()), bar_px, canvas);
  }
  if (controller.shows_help()) DrawHelp(canvas);
}

}  // namespace sextant::cli
