// SPDX-License-Identifier: Apache-2.0
#include "report/page/html_parts.h"

#include <fmt/core.h>

#include <cmath>

#include "base/text/escape.h"
#include "eval/statistics/text_table.h"
#include "report/page/base64.h"

namespace sextant {
namespace {

std::string RowHtml(const std::vector<std::string>& cells, std::size_t words,
                    std::string_view element) {
  std::string row = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    row += fmt::format("<{0}{1}>{2}</{0}>", element, i < words ? "" : " class=\"n\"",
                       HtmlText(cells[i]));
  }
  return row + "</tr>\n";
}

}  // namespace

std::string SectionHtml(std::string_view id, std::string_view title, std::string_view body) {
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, title, body);
}

std::string TableHtml(const PageTable& table) {
  std::string html;
  if (!table.rows.empty()) {
    html = "<div class=\"wide\"><table>\n";
    if (!table.header.empty()) {
      html += "<thead>" + RowHtml(table.header, table.words, "th") + "</thead>\n";
    }
    html += "<tbody>\n";
    for (const std::vector<std::string>& row : table.rows) html += RowHtml(row, table.words, "td");
    html += "</tbody></table></div>\n";
  }
  if (!table.note.empty()) html += fmt::format("<p class=\"note\">{}</p>\n", HtmlText(table.note));
  return html;
}

std::string PictureHtml(std::string_view type, std::string_view bytes, const std::string& text) {
  return fmt::format("<img alt=\"{}\" src=\"data:image/{};base64,{}\">", HtmlText(text), type,
                     Base64(bytes));
}

std::string NumberHtml(const std::optional<double>& value, double scale, int decimals) {
  if (!value || !std::isfinite(*value)) return "–";
  return Fixed(scale * *value, decimals);
}

}  // namespace sextant
