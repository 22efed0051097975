// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "io/text/number_text.h"

namespace sextant {

/// Reads a text line by line, splits each line into fields, and keeps the first error.
///
/// Blank lines, lines that begin with '#', a byte order mark and carriage returns are skipped.
/// After an error every call does nothing, so a parser needs to check ok() only once, at its end.
/// Time is linear in the text, memory 16 bytes for each field of a line, which has at most 1000.
class LineReader {
 public:
  enum class Separator { kBlanks, kCommas, kSemicolons };

  /// The text must outlive the reader.
  LineReader(std::string file, std::string_view text, Separator separator = Separator::kBlanks);

  /// Goes to the next line; false at the end or after an error.
  bool Next();
  /// Whether only blank lines and comments follow.
  bool AtEnd() const;
  /// As Next, but the end of the text is an error: "the file ends here, expected <what>".
  bool Require(std::string_view what);
  /// Whether the line has `count` fields; if not, an error states that `what` was expected.
  bool HasFields(std::size_t count, std::string_view what);

  std::size_t field_count() const { return fields_.size(); }
  std::string_view Field(std::size_t index) const { return fields_[index]; }
  int line() const { return line_; }

  /// The value of a field of this line; fields count from 0 and must exist. Zero after an error.
  double Real(std::size_t index, std::string_view name = {});
  std::int64_t Integer(std::size_t index, std::int64_t low, std::int64_t high,
                       std::string_view name = {});
  /// The same for a text that is part of field `index`.
  double RealOf(std::string_view text, std::size_t index, std::string_view name = {});
  std::int64_t IntegerOf(std::string_view text, std::size_t index, std::int64_t low,
                         std::int64_t high, std::string_view name = {});

  /// Records an error at the current line, unless there is one already.
  void Fail(ErrorCode code, std::string_view message);
  void Fail(Error error);
  bool ok() const { return !error_; }
  /// The first error, for a function that returns an Expected. Requires !ok().
  tl::unexpected<Error> TakeError();

 private:
  void Split(std::string_view line);
  std::string_view TakeLine();

  std::string file_;
  std::string_view rest_;
  Separator separator_;
  int line_ = 0;
  std::vector<std::string_view> fields_;
  std::optional<Error> error_;
};

}  // namespace sextant
