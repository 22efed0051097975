// SPDX-License-Identifier: Apache-2.0
#include "report/page/page_html.h"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text/escape.h"
#include "report/page/assets.h"
#include "report/page/html_parts.h"
#include "report/page/photo_svg.h"
#include "report/page/plot_svg.h"
#include "report/page/scene_json.h"
#include "report/page/summary_html.h"
#include "report/page/top_view.h"
#include "report/page/views_html.h"

namespace sextant {
namespace {

std::string PlotsHtml(const std::vector<PagePlot>& plots) {
  std::string html;
  for (const PagePlot& plot : plots) html += PlotHtml(plot);
  return html;
}

// A page without views, as that of a rig, has no place for pictures of them.
std::string InGrid(const ReportPage& page, const std::string& figures) {
  if (!figures.empty()) return "<div class=\"grid-of-plots\">\n" + figures + "</div>\n";
  return page.views.empty() ? "" : "<p>No data for these pictures.</p>\n";
}

std::string SensorsHtml(const std::vector<PageSensor>& sensors) {
  if (sensors.empty()) return {};
  std::string html = "<div class=\"two\">\n";
  for (const PageSensor& sensor : sensors) {
    html +=
        fmt::format("<div><h3>{}</h3>\n{}</div>\n", HtmlText(sensor.name), TableHtml(sensor.facts));
  }
  return html + "</div>\n";
}

std::string NextHtml(const PageNext& next) {
  std::string html;
  for (const std::string& line : next.sentences) html += "<p>" + HtmlText(line) + "</p>\n";
  if (next.png.empty()) return html;
  return html + "<figure class=\"picture\">" +
         PictureHtml("png", next.png, "The next placement from above and in the camera's image") +
         "</figure>\n";
}

std::string InputsHtml(const ReportPage& page, bool has_3d) {
  std::string html = TableHtml(page.inputs.files);
  if (!page.configuration.empty()) {
    html += "<details><summary>Configuration</summary><pre>";
    for (const std::string& line : page.configuration) html += HtmlText(line) + "\n";
    html += "</pre></details>\n";
  }
  if (has_3d) {
    html += "<details><summary>Licence of three.js, which this page contains</summary><pre>";
    html += std::string(ThreeLicence()) + "</pre></details>\n";
  }
  return html;
}

std::string UncertaintyHtml(const ReportPage& page) {
  std::string html;
  if (!page.sigma_text.empty()) html += "<p>" + HtmlText(page.sigma_text) + "</p>\n";
  html += TableHtml(page.sigmas);
  std::string figures = PlotsHtml(page.sigma_plots);
  if (page.correlation) figures += CorrelationHtml(*page.correlation);
  return html + InGrid(page, figures);
}

std::string TransformsHtml(const ReportPage& page) {
  std::string html;
  if (page.transforms.empty() && !page.sensors.empty()) {
    html = "<p class=\"lead\">No transform was found, so there is none to use.</p>\n";
  }
  // Where there are views, they have a picture with the boards.
  if (page.views.empty() && !page.transforms.empty()) html += TopViewHtml(page);
  for (const PageTransform& transform : page.transforms) html += TransformHtml(transform);
  return html + SensorsHtml(page.sensors);
}

std::string CoverageSection(const ReportPage& page) {
  std::string figures;
  for (const PageCoverage& coverage : page.coverage) figures += CoverageHtml(coverage);
  return InGrid(page, figures + PlotsHtml(page.coverage_plots));
}

std::string ParagraphHtml(const std::string& text) {
  return text.empty() ? text : "<p>" + HtmlText(text) + "</p>\n";
}

std::string ChecksHtml(const ReportPage& page) {
  std::string html;
  for (const std::string& line : page.diagnostics) html += "<li>" + HtmlText(line) + "</li>\n";
  if (!html.empty()) {
    html = "<ul class=\"diagnostics\">\n" + html + "</ul>\n";
  } else if (!page.live) {
    html = "<p>The checks of the data found nothing to report.</p>\n";
  }
  return html + ParagraphHtml(page.closing);
}

std::string OwnSectionHtml(const PageSection& section) {
  std::string html;
  for (const std::string& sentence : section.sentences) html += ParagraphHtml(sentence);
  return html + TableHtml(section.table);
}

struct Part {
  std::string id;
  std::string title;
  std::string label;  // In the contents; empty: not there.
  std::string body;
};

// Those that have anything to show.
std::vector<Part> PartsOf(const ReportPage& page, bool has_3d) {
  std::vector<Part> parts;
  const auto add = [&parts](std::string id, std::string title, std::string label,
                            std::string body) {
    if (body.empty()) return;
    parts.push_back({std::move(id), std::move(title), std::move(label), std::move(body)});
  };
  add("diagnostics", "What the checks found", "", ChecksHtml(page));
  add("transform", page.transforms.size() > 1 ? "The transforms" : "The transform", "Transform",
      TransformsHtml(page));
  for (const PageSection& section : page.sections) {
    add(section.id, section.title, section.label, OwnSectionHtml(section));
  }
  if (!page.views.empty()) add("views", "The views", "Views", ViewsHtml(page, has_3d));
  add("coverage", "Where the boards were", "Coverage", CoverageSection(page));
  add("residuals", "Residuals", "Residuals", InGrid(page, PlotsHtml(page.residual_plots)));
  add("uncertainty", "Uncertainty", "Uncertainty", UncertaintyHtml(page));
  add("noise", "Noise and nuisance parameters", "Noise", TableHtml(page.noise));
  add("solvers", "Other solvers on the same data", "Solvers", TableHtml(page.comparison));
  // While a capture runs, this is at the top.
  if (!page.live) add("next", "Where to hold the board next", "Next board", NextHtml(page.next));
  add("inputs", "Inputs", "Inputs", InputsHtml(page, has_3d));
  return parts;
}

std::string LiveHtml(const ReportPage& page) {
  std::string found;
  for (const std::string& line : page.live->found) found += "<li>" + HtmlText(line) + "</li>\n";
  if (found.empty()) found = "<li>Nothing yet.</li>\n";
  return fmt::format(
      "<section id=\"now\" class=\"now\">\n<p class=\"live{}\" id=\"live-state\" "
      "role=\"status\">{}</p>\n<div class=\"two\">\n<div><h2>Hold the board here next</h2>\n{}"
      "</div>\n<div><h2>Just found</h2>\n<ul class=\"found\">\n{}</ul></div>\n</div>\n"
      "</section>\n",
      page.live->has_ended ? " ended" : "", HtmlText(page.live->state), NextHtml(page.next), found);
}

std::string BodyHtml(const ReportPage& page, bool has_3d) {
  const std::vector<Part> parts = PartsOf(page, has_3d);
  std::string html = SummaryHtml(page);
  if (page.live) html += LiveHtml(page);
  html += "<nav aria-label=\"Contents\">";
  for (const Part& part : parts) {
    if (part.label.empty()) continue;
    html += fmt::format("<a href=\"#{}\">{}</a>", part.id, HtmlText(part.label));
  }
  html += "</nav>\n";
  for (const Part& part : parts) html += SectionHtml(part.id, HtmlText(part.title), part.body);
  return html;
}

// A page that runs asks its own server, and no other, whether there is news.
std::string HeadHtml(const ReportPage& page) {
  const std::string_view more = page.live ? "; connect-src 'self'" : "";
  // Without an icon, browsers ask the server for one.
  const std::string_view icon = page.live ? "<link rel=\"icon\" href=\"data:,\">\n" : "";
  const bool runs = page.live && !page.live->has_ended;
  const std::string_view reload =
      runs ? "<noscript><meta http-equiv=\"refresh\" content=\"5\"></noscript>\n" : "";
  return fmt::format(
      "<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src "
      "'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'{}\">\n{}{}"
      "<title>{}</title>\n<style>\n{}</style>\n</head>\n",
      more, icon, reload, HtmlText(page.title), PageStyle());
}

}  // namespace

std::string FormatPage(const ReportPage& page) {
  const bool has_scan = std::any_of(page.views.begin(), page.views.end(), [](const PageView& view) {
    return view.scan.has_value() || !view.boards.empty();
  });
  const bool has_3d = has_scan && !ThreeScript().empty();
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n" + HeadHtml(page);
  html += page.live
              ? fmt::format("<body data-revision=\"{}\">\n<main>\n", HtmlText(page.live->revision))
              : "<body>\n<main>\n";
  html += BodyHtml(page, has_3d);
  html +=
      "</main>\n<script type=\"application/json\" id=\"scene\">" + SceneJson(page) + "</script>\n";
  if (has_3d) {
    html +=
        fmt::format("<script>\n{}</script>\n<script>\n{}</script>\n", ThreeScript(), SceneScript());
  }
  html += fmt::format("<script>\n{}</script>\n", PageScript());
  if (page.live && !page.live->has_ended) {
    html += fmt::format("<script>\n{}</script>\n", LiveScript());
  }
  return html + "</body>\n</html>\n";
}

}  // namespace sextant
