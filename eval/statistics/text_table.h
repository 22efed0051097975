// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sextant {

/// A table of text with a rule under the header.
class TextTable {
 public:
  enum class Columns {
    kNumbers,  ///< The first column flush left, the others flush right.
    kWords,    ///< All flush left.
  };

  explicit TextTable(std::vector<std::string> header, Columns columns = Columns::kNumbers)
      : rows_{std::move(header)}, columns_(columns) {}

  /// A row of as many cells as the header.
  void AddRow(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

  /// For a terminal; every line ends with a line feed and has no blanks at its end.
  std::string Plain() const;

  /// For a page: GitHub's Markdown.
  std::string Markdown() const;

  /// A tabular with the rules of the package booktabs.
  std::string Latex() const;

 private:
  std::vector<std::size_t> Widths() const;
  bool IsFlushLeft(std::size_t column) const { return column == 0 || columns_ == Columns::kWords; }

  std::vector<std::vector<std::string>> rows_;
  Columns columns_;
};

/// The text with the signs escaped that LaTeX takes for its own; these texts have no backslashes,
/// braces, tildes or carets.
std::string LatexText(std::string_view text);

/// The number with so many decimals, and no minus before zeros.
std::string Fixed(double value, int decimals);

}  // namespace sextant
