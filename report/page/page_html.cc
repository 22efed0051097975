// SPDX-License-Identifier: Apache-2.0
#include "report/page/page_html.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text/escape.h"
#include "report/page/assets.h"
#include "report/page/html_parts.h"
#include "report/page/photo_svg.h"
#include "report/page/plot_svg.h"
#include "report/page/scene_json.h"
#include "report/page/summary_html.h"
#include "report/page/views_html.h"

namespace sextant {
namespace {

std::string DiagnosticsHtml(const std::vector<std::string>& diagnostics) {
  if (diagnostics.empty()) return "<p>The checks of the data found nothing to report.</p>\n";
  std::string html = "<ul class=\"diagnostics\">\n";
  for (const std::string& line : diagnostics) html += "<li>" + HtmlText(line) + "</li>\n";
  return html + "</ul>\n";
}

std::string PlotsHtml(const std::vector<PagePlot>& plots) {
  std::string html;
  for (const PagePlot& plot : plots) html += PlotHtml(plot);
  return html;
}

std::string InGrid(const std::string& figures) {
  if (figures.empty()) return "<p>No data for these pictures.</p>\n";
  return "<div class=\"grid-of-plots\">\n" + figures + "</div>\n";
}

std::string SensorsHtml(const std::vector<PageSensor>& sensors) {
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

std::string InputsHtml(const ReportPage& page) {
  std::string html = TableHtml(page.inputs.files);
  if (!page.configuration.empty()) {
    html += "<details><summary>Configuration</summary><pre>";
    for (const std::string& line : page.configuration) html += HtmlText(line) + "\n";
    html += "</pre></details>\n";
  }
  if (!ThreeScript().empty()) {
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
  return html + InGrid(figures);
}

std::string TransformsHtml(const ReportPage& page) {
  std::string html;
  if (page.transforms.empty()) {
    html = "<p class=\"lead\">No transform was found, so there is none to use.</p>\n";
  }
  for (const PageTransform& transform : page.transforms) html += TransformHtml(transform);
  return html + SensorsHtml(page.sensors);
}

std::string CoverageSection(const ReportPage& page) {
  std::string figures;
  for (const PageCoverage& coverage : page.coverage) figures += CoverageHtml(coverage);
  return InGrid(figures + PlotsHtml(page.coverage_plots));
}

std::string BodyHtml(const ReportPage& page, bool has_3d) {
  const auto paragraph = [](const std::string& text) {
    return text.empty() ? text : "<p>" + HtmlText(text) + "</p>\n";
  };
  return SummaryHtml(page) +
         "<nav aria-label=\"Contents\"><a href=\"#transform\">Transform</a><a href=\"#views\">"
         "Views</a><a href=\"#coverage\">Coverage</a><a href=\"#residuals\">Residuals</a><a "
         "href=\"#uncertainty\">Uncertainty</a><a href=\"#noise\">Noise</a><a "
         "href=\"#solvers\">Solvers</a><a href=\"#next\">Next board</a><a href=\"#inputs\">Inputs"
         "</a></nav>\n" +
         SectionHtml("diagnostics", "What the checks found",
                     DiagnosticsHtml(page.diagnostics) + paragraph(page.closing)) +
         SectionHtml("transform", "The transform", TransformsHtml(page)) +
         SectionHtml("views", "The views", ViewsHtml(page, has_3d)) +
         SectionHtml("coverage", "Where the boards were", CoverageSection(page)) +
         SectionHtml("residuals", "Residuals", InGrid(PlotsHtml(page.residual_plots))) +
         SectionHtml("uncertainty", "Uncertainty", UncertaintyHtml(page)) +
         SectionHtml("noise", "Noise and nuisance parameters", TableHtml(page.noise)) +
         SectionHtml("solvers", "Other solvers on the same data", TableHtml(page.comparison)) +
         SectionHtml("next", "Where to hold the board next", NextHtml(page.next)) +
         SectionHtml("inputs", "Inputs", InputsHtml(page));
}

}  // namespace

std::string FormatPage(const ReportPage& page) {
  const bool has_scan = std::any_of(page.views.begin(), page.views.end(), [](const PageView& view) {
    return view.scan.has_value() || !view.boards.empty();
  });
  const bool has_3d = has_scan && !ThreeScript().empty();
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
      "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta "
      "http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n<title>{}</title>\n<style>\n{}"
      "</style>\n</head>\n<body>\n<main>\n",
      HtmlText(page.title), PageStyle());
  html += BodyHtml(page, has_3d);
  html +=
      "</main>\n<script type=\"application/json\" id=\"scene\">" + SceneJson(page) + "</script>\n";
  if (has_3d) {
    html +=
        fmt::format("<script>\n{}</script>\n<script>\n{}</script>\n", ThreeScript(), SceneScript());
  }
  html += fmt::format("<script>\n{}</script>\n</body>\n</html>\n", PageScript());
  return html;
}

}  // namespace sextant
