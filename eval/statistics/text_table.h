// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sextant {

/// A table of text cells with a rule under the header.
class TextTable {
 public:
  enum class Columns {
    kNumbers,  ///< The first column flush left, the others flush right.
    kWords,    ///< All flush left.
  };

  explicit TextTable(std::vector<std::string> header, Columns columns = Columns::kNumbers)
      : rows_{std::move(header)}, columns_(columns) {}

  /// Appends a row, which must have as many cells as the header.
  void AddRow(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

  /// Text for a terminal; every line ends with a line feed and has no trailing blanks.
  std::string Plain() const;

  /// A Markdown table (GitHub's dialect).
  std::string Markdown() const;

  /// A LaTeX tabular with the rules of the package booktabs.
  std::string Latex() const;

 private:
  std::vector<std::size_t> Widths() const;
  bool IsFlushLeft(std::size_t column) const { return column == 0 || columns_ == Columns::kWords; }

  std::vector<std::vector<std::string>> rows_;
  Columns columns_;
};

/// The text with LaTeX's special characters _ % & # $ escaped. Backslashes, braces, tildes and
/// carets are not handled, as our texts have none.
std::string LatexText(std::string_view text);

/// The number with a fixed number of decimals, without a minus sign if it rounds to zero.
std::string Fixed(double value, int decimals);

}  // namespace sextant
