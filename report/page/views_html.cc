// SPDX-License-Identifier: Apache-2.0
#include "report/page/views_html.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include "base/text/escape.h"
#include "base/units.h"
#include "report/page/html_parts.h"
#include "report/page/photo_svg.h"
#include "report/page/top_view.h"

namespace sextant {
namespace {

std::string CornerName(std::size_t corner) {
  constexpr std::array<std::string_view, 4> kNames = {"top", "right", "bottom", "left"};
  return fmt::format("{} {}{}", corner, corner < 4 ? "" : "opening, ", kNames[corner % 4]);
}

std::string RangesOf(const PageView& view) {
  std::string text;
  for (const PageBoard& board : view.boards) {
    if (board.range_m > 0.0) text += (text.empty() ? "" : ", ") + NumberHtml(board.range_m, 1.0, 2);
  }
  return text.empty() ? "–" : text;
}

std::optional<double> SigmaOf(const PageView& view, bool rotation) {
  if (!view.sigma_so_far) return std::nullopt;
  return rotation ? view.sigma_so_far->head<3>().norm() : view.sigma_so_far->tail<3>().norm();
}

std::string ViewRow(const PageView& view, std::size_t index) {
  std::string status = view.is_kept ? "kept" : "<b>left out</b>";
  if (!view.reason.empty()) status += ": " + HtmlText(view.reason);
  return fmt::format(
      "<tr data-view=\"{0}\"><td><a href=\"#view-{0}\">{1}</a></td><td class=\"why\">{2}</td>"
      "<td class=\"n\">{3}</td><td class=\"n\">{4}</td><td class=\"n\">{5}</td>"
      "<td class=\"n\">{6}</td><td class=\"n\">{7}</td><td class=\"n\">{8}</td></tr>\n",
      index, HtmlText(view.name), status, RangesOf(view), NumberHtml(view.rmse_m, 1e3, 1),
      NumberHtml(view.rmse_px, 1.0, 2), NumberHtml(view.held_out_m, 1e3, 1),
      NumberHtml(SigmaOf(view, false), 1e3, 1), NumberHtml(SigmaOf(view, true), kDegPerRad, 3));
}

// Without boards, as in a check, a view has a name alone.
std::string NamesTable(const std::vector<PageView>& views) {
  std::string html =
      "<div class=\"wide views\"><table><thead><tr><th>View</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < views.size(); ++i) {
    html += fmt::format("<tr data-view=\"{0}\"><td><a href=\"#view-{0}\">{1}</a></td></tr>\n", i,
                        HtmlText(views[i].name));
  }
  return html + "</tbody></table></div>\n";
}

std::string ViewsTable(const std::vector<PageView>& views) {
  const bool has_boards = std::ranges::any_of(views, [](const PageView& view) {
    return !view.boards.empty() || !view.is_kept || view.rmse_m.has_value();
  });
  if (!has_boards) return NamesTable(views);
  std::string html =
      "<div class=\"wide views\"><table><thead><tr><th>View</th><th>Status</th>"
      "<th class=\"n\">Range [m]</th><th class=\"n\">Off [mm]</th><th class=\"n\">Off [px]</th>"
      "<th class=\"n\">Held out [mm]</th><th class=\"n\">Sigma after [mm]</th>"
      "<th class=\"n\">[deg]</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < views.size(); ++i) html += ViewRow(views[i], i);
  return html +
         "</tbody></table></div>\n<p class=\"note\">Off: RMS distance of the corners by the camera "
         "and by the LiDAR, under the result. Held out: the same under the result of the other "
         "views. Sigma after: predicted with this view and all before it, over all axes.</p>\n";
}

std::string CornersTable(const PageView& view) {
  std::string rows;
  const auto at = [](const std::vector<double>& values, std::size_t i) {
    return i < values.size() ? values[i] : std::numeric_limits<double>::infinity();
  };
  for (const PageBoard& board : view.boards) {
    const std::size_t corners = std::max(board.residuals_m.size(), board.residuals_px.size());
    for (std::size_t i = 0; i < corners; ++i) {
      rows += fmt::format(
          "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
          HtmlText(board.name), CornerName(i), NumberHtml(at(board.residuals_m, i), 1e3, 1),
          NumberHtml(at(board.residuals_px, i), 1.0, 2));
    }
  }
  if (rows.empty()) return rows;
  return "<div class=\"wide\"><table><thead><tr><th>Board</th><th>Corner</th>"
         "<th class=\"n\">Off [mm]</th><th class=\"n\">Off [px]</th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div>\n";
}

std::string CardHtml(const PageView& view, std::size_t index) {
  std::string html =
      fmt::format("<article class=\"card\" id=\"view-{0}\" data-view=\"{0}\">\n<h3>View {1}", index,
                  HtmlText(view.name));
  html += fmt::format(" <small>{}{}{}</small></h3>\n", view.is_kept ? "kept" : "left out",
                      view.time.empty() ? "" : " · ", HtmlText(view.time));
  if (!view.reason.empty()) html += fmt::format("<p class=\"why\">{}</p>\n", HtmlText(view.reason));
  if (view.photo) {
    html += PhotoHtml(view);
    html +=
        "<label class=\"with-script opacity\">Scan over the photo <input type=\"range\" min=\"0\" "
        "max=\"100\" value=\"90\"><output>90 %</output></label>\n";
  }
  if (!view.no_photo.empty()) {
    html += fmt::format("<p class=\"note\">{}</p>\n", HtmlText(view.no_photo));
  }
  return html + CornersTable(view) + "</article>\n";
}

constexpr std::string_view kControls = R"(<div class="toolbar">
<label>View <select id="moment"></select></label>
<label>Colour <select id="colour"><option value="range">range</option>
<option value="intensity">intensity</option><option value="photo">photo</option></select></label>
<label>Look <select id="look"><option value="overview">overview</option>
<option value="top">from above</option><option value="side">from the side</option>
<option value="camera">from the camera</option><option value="lidar">from the LiDAR</option>
</select></label>
<button type="button" id="measure" aria-pressed="false">Measure</button>
<button type="button" id="nearer" aria-label="nearer">+</button>
<button type="button" id="farther" aria-label="farther">−</button>
</div>
<div class="toolbar checks">
<label><input type="checkbox" data-part="scan" checked> scan</label>
<label><input type="checkbox" data-part="camera" checked> <i class="line by-camera"></i>boards by the camera</label>
<label><input type="checkbox" data-part="lidar" checked> <i class="line by-lidar"></i>boards by the LiDAR</label>
<label><input type="checkbox" data-part="others" checked> boards of other views</label>
<label><input type="checkbox" data-part="frusta" checked> camera's view</label>
<label><input type="checkbox" data-part="axes" checked> axes</label>
</div>
<div id="stage" tabindex="0" role="img" aria-label="3D view of the scan, the boards and the sensors"></div>
<p class="note" id="stage-note" role="status"></p>
)";

std::string StageHtml(const ReportPage& page, bool has_3d) {
  std::string html = "<div class=\"stage\">\n";
  if (has_3d) {
    html += "<div class=\"with-script in-3d\">\n" + std::string(kControls) + "</div>\n";
  }
  html += "<div class=\"still\">\n" + TopViewHtml(page);
  html += has_3d ? "<p class=\"note no-3d\">With JavaScript and WebGL this is a view in three "
                   "dimensions.</p>\n"
                 : "<p class=\"note\">The program that wrote this page was built without three.js, "
                   "so this picture stands for the view in three dimensions.</p>\n";
  return html + "</div></div>\n";
}

}  // namespace

std::string ViewsHtml(const ReportPage& page, bool has_3d) {
  std::string html = ViewsTable(page.views);
  html +=
      "<p class=\"note with-script\">Select a row to see the view below, and in three "
      "dimensions.</p>\n";
  html += "<div class=\"bench\">\n" + StageHtml(page, has_3d) + "<div class=\"cards\">\n";
  for (std::size_t i = 0; i < page.views.size(); ++i) html += CardHtml(page.views[i], i);
  return html + "</div></div>\n";
}

}  // namespace sextant
