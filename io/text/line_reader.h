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

/// The lines of a text, split into fields, with the first error kept.
///
/// Blank lines, lines that begin with '#', a byte order mark and carriage returns are skipped.
/// After an error every call does nothing, so that a format reads straight down and asks once.
class LineReader {
 public:
  enum class Separator { kBlanks, kCommas };

  /// The text must outlive the reader.
  LineReader(std::string file, std::string_view text, Separator separator = Separator::kBlanks);

  /// Goes to the next line; false at the end or after an error.
  bool Next();
  /// Whether nothing but blank lines and comments follows.
  bool AtEnd() const;
  /// As Next, but the end is an error: "the file ends, expected <what>".
  bool Require(std::string_view what);
  /// Whether the line has `count` fields; else an error that names what was expected.
  bool HasFields(std::size_t count, std::string_view what);

  std::size_t field_count() const { return fields_.size(); }
  std::string_view Field(std::size_t index) const { return fields_[index]; }
  int line() const { return line_; }

  /// A field of this line, from 0, which must exist; zero after an error.
  double Real(std::size_t index, std::string_view name = {});
  std::int64_t Integer(std::size_t index, std::int64_t low, std::int64_t high,
                       std::string_view name = {});
  /// The same of a text that is part of field `index`.
  double RealOf(std::string_view text, std::size_t index, std::string_view name = {});
  std::int64_t IntegerOf(std::string_view text, std::size_t index, std::int64_t low,
                         std::int64_t high, std::string_view name = {});

  /// Of this line, unless an error came before.
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
