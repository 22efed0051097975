// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sextant {

/// A table of text cells with a rule under the header. Cells may be any text of others: each output
/// has them on one line, and escaped as its format requires.
class TextTable {
 public:
  enum class Columns {
    kNumbers,  ///< The first column flush left, the others flush right.
    kWords,    ///< All flush left.
  };

  explicit TextTable(std::vector<std::string> header, Columns columns = Columns::kNumbers)
      : columns_(columns) {
    AddRow(std::move(header));
  }

  /// Appends a row, which must have as many cells as the header.
  void AddRow(std::vector<std::string> cells);

  /// Text for a terminal; every line ends with a line feed and has no trailing blanks. Where the
  /// lines would be longer than `max_width` characters, the first column or, of words, the widest
  /// columns are wrapped; if that is not enough, the last columns follow below, beside the first
  /// one again.
  std::string Plain(std::size_t max_width = 100) const;

  /// A Markdown table (GitHub's dialect); code in `backquotes` stays code.
  std::string Markdown() const;

  /// A LaTeX tabular with the rules of the package booktabs.
  std::string Latex() const;

 private:
  std::vector<std::size_t> Widths(std::size_t max_width) const;
  std::string PlainRow(const std::vector<std::string>& row, const std::vector<std::size_t>& widths,
                       const std::vector<std::size_t>& columns) const;
  bool IsFlushLeft(std::size_t column) const { return column == 0 || columns_ == Columns::kWords; }

  std::vector<std::vector<std::string>> rows_;
  Columns columns_;
};

/// The length to 1e-8 m: "8.21334 mm" below 1 m, "1.20000000 m" from there on.
std::string LengthText(double metres);

/// The number with a fixed number of decimals, without a minus sign if it rounds to zero.
std::string Fixed(double value, int decimals);

}  // namespace sextant
