// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/text/line_reader.h"

namespace sextant {

/// The text of a table and the mark between its columns, which the first line that is no comment
/// has: a semicolon, else a comma, else blanks or tabs. Between semicolons, commas are decimal ones
/// and become points.
class CsvText {
 public:
  explicit CsvText(std::string_view text);
  CsvText(const CsvText&) = delete;
  CsvText& operator=(const CsvText&) = delete;

  std::string_view text() const { return copy_.empty() ? text_ : std::string_view(copy_); }
  LineReader::Separator separator() const { return separator_; }

 private:
  std::string_view text_;
  std::string copy_;  ///< With decimal points; empty where nothing changes.
  LineReader::Separator separator_ = LineReader::Separator::kBlanks;
};

/// The columns of a file of pairs by the names that pairs_csv.h lists; others keep theirs.
struct CsvHeader {
  std::vector<std::string> columns;
  bool has_names = true;           ///< False: the first line is a row of numbers.
  std::vector<std::string> notes;  ///< What was assumed, one sentence each.
};

/// A column's name without capitals, quotes, blanks, underscores and a unit in brackets.
std::string PlainColumn(std::string_view name);

/// Reads the current line of `in` as the header.
/// - Capitals, blanks, underscores, quotes and units in brackets do not matter, and names of other
///   programs are known: px, pixel_x or col for u; lidar_x, x_lidar or world_x for x. In a file
///   with x, y, X, Y and Z, the small letters are pixels.
/// - A line of five numbers is u,v,x,y,z, or x,y,z,u,v where only the last two are as large as
///   pixels; one of six is camx,camy,camz,lidarx,lidary,lidarz. The number of rows may precede it.
/// - A column with another name is not used, and a note names it. One that resembles a known name
///   is an error with a suggestion, and so is a name that appears twice.
CsvHeader ReadCsvHeader(LineReader& in);

}  // namespace sextant
