// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace sextant {

std::vector<std::size_t> TextTable::Widths() const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  return widths;
}

std::string TextTable::Plain() const {
  const std::vector<std::size_t> widths = Widths();
  std::string text;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) line += "  ";
      line += IsFlushLeft(i) ? fmt::format("{:<{}}", row[i], widths[i])
                             : fmt::format("{:>{}}", row[i], widths[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
    if (&row == &rows_.front()) {
      const std::size_t gaps = 2 * (widths.size() - 1);
      text += std::string(std::accumulate(widths.begin(), widths.end(), gaps), '-') + "\n";
    }
  }
  return text;
}

std::string TextTable::Markdown() const {
  std::string text;
  for (const auto& row : rows_) {
    text += fmt::format("| {} |\n", fmt::join(row, " | "));
    if (&row != &rows_.front()) continue;
    for (std::size_t i = 0; i < row.size(); ++i) text += IsFlushLeft(i) ? "|:--" : "|--:";
    text += "|\n";
  }
  return text;
}

std::string TextTable::Latex() const {
  std::string columns;
  for (std::size_t i = 0; i < rows_.front().size(); ++i) columns += IsFlushLeft(i) ? 'l' : 'r';
  std::string text = fmt::format("\\begin{{tabular}}{{{}}}\n\\toprule\n", columns);
  for (const auto& row : rows_) {
    text += LatexText(row.front());
    for (std::size_t i = 1; i < row.size(); ++i) text += " & " + LatexText(row[i]);
    text += " \\\\\n";
    if (&row == &rows_.front()) text += "\\midrule\n";
  }
  return text + "\\bottomrule\n\\end{tabular}\n";
}

std::string LatexText(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (std::string_view("_%&#$").find(c) != std::string_view::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string Fixed(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

}  // namespace sextant
