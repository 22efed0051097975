// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "base/text/escape.h"
#include "base/text/printable.h"
#include "base/units.h"

namespace sextant {
namespace {

constexpr std::size_t kGap = 2;

// The width of a line of columns.
std::size_t SumOf(const std::vector<std::size_t>& widths) {
  return std::accumulate(widths.begin(), widths.end(), kGap * (widths.size() - 1));
}

// The columns of each block of lines, the first column in all of them.
std::vector<std::vector<std::size_t>> BlocksOf(const std::vector<std::size_t>& widths,
                                               std::size_t max_width) {
  std::vector<std::vector<std::size_t>> blocks = {{0}};
  std::size_t width = widths[0];
  for (std::size_t i = 1; i < widths.size(); ++i) {
    if (width + kGap + widths[i] > max_width && blocks.back().size() > 1) {
      blocks.push_back({0});
      width = widths[0];
    }
    blocks.back().push_back(i);
    width += kGap + widths[i];
  }
  return blocks;
}

// The lines of a cell: broken at blanks and after the bars between choices, else within specs, else
// anywhere.
std::vector<std::string> WrapText(std::string_view text, std::size_t width) {
  std::vector<std::string> lines;
  while (text.size() > width) {
    // npos + 1 is 0, as for a break at the beginning.
    const std::size_t after_blank = text.substr(0, width + 1).rfind(' ') + 1;
    const std::size_t after_bar = text.substr(0, width).rfind('|') + 1;
    std::size_t end = std::max(after_blank, after_bar);
    if (end == 0) end = text.substr(0, width).find_last_of(",(") + 1;
    if (end == 0) end = width;
    lines.emplace_back(text.substr(0, end == after_blank ? end - 1 : end));
    text.remove_prefix(end);
  }
  lines.emplace_back(text);
  return lines;
}

}  // namespace

void TextTable::AddRow(std::vector<std::string> cells) {
  for (std::string& cell : cells) cell = PrintableLine(std::move(cell));
  rows_.push_back(std::move(cells));
}

std::vector<std::size_t> TextTable::Widths(std::size_t max_width) const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  if (columns_ == Columns::kNumbers) {
    if (SumOf(widths) > max_width) widths[0] = std::min(widths[0], max_width * 2 / 5);
    return widths;
  }
  // Narrower columns would be harder to read than long lines.
  constexpr std::size_t kMinWrapped = 16;
  while (SumOf(widths) > max_width) {
    const auto widest = std::max_element(widths.begin(), widths.end());
    if (*widest <= kMinWrapped) break;
    --*widest;
  }
  return widths;
}

std::string TextTable::PlainRow(const std::vector<std::string>& row,
                                const std::vector<std::size_t>& widths,
                                const std::vector<std::size_t>& columns) const {
  std::vector<std::vector<std::string>> cells;
  std::size_t height = 0;
  for (const std::size_t i : columns) {
    height = std::max(height, cells.emplace_back(WrapText(row[i], widths[i])).size());
  }
  std::string text;
  for (std::size_t k = 0; k < height; ++k) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string cell = k < cells[i].size() ? cells[i][k] : std::string();
      if (i > 0) line += std::string(kGap, ' ');
      const std::size_t column = columns[i];
      line += IsFlushLeft(column) ? fmt::format("{:<{}}", cell, widths[column])
                                  : fmt::format("{:>{}}", cell, widths[column]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string TextTable::Plain(std::size_t max_width) const {
  const std::vector<std::size_t> widths = Widths(max_width);
  std::string text;
  for (const std::vector<std::size_t>& block : BlocksOf(widths, max_width)) {
    if (!text.empty()) text += "\n";
    std::vector<std::size_t> shown;
    for (const std::size_t column : block) shown.push_back(widths[column]);
    for (const auto& row : rows_) {
      text += PlainRow(row, widths, block);
      if (&row == &rows_.front()) text += std::string(SumOf(shown), '-') + "\n";
    }
  }
  return text;
}

std::string TextTable::Markdown() const {
  std::string text;
  for (const auto& row : rows_) {
    std::vector<std::string> cells;
    for (const std::string& cell : row) cells.push_back(MarkdownText(cell));
    text += fmt::format("| {} |\n", fmt::join(cells, " | "));
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

std::string LengthText(double metres) {
  return metres < 1.0 ? fmt::format("{:.5f} mm", metres * kMmPerM)
                      : fmt::format("{:.8f} m", metres);
}

std::string Fixed(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

}  // namespace sextant
