// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

#include "base/text/printable.h"

namespace sextant {

/// The kind of an error. The message of an Error names the input and the remedy.
enum class ErrorCode {
  kMissingData,    ///< The problem has none of a kind of data that the solver needs.
  kTooFewPairs,    ///< Fewer data than the minimum, but not none.
  kNonFinite,      ///< An input number is NaN or infinite.
  kInvalidInput,   ///< An input is finite but outside its domain (negative sigma, no focal length).
  kDegenerate,     ///< The geometry leaves a direction of the pose undetermined.
  kMirrored,       ///< One point set is a mirror image of the other: no rotation maps them.
  kNoConsensus,    ///< No pose gathers enough inliers.
  kNoConvergence,  ///< An iteration did not reach its stopping inequality.
  kUnknownName,    ///< No solver, option or choice has that name.
  kInvalidOption,  ///< An option's value is outside its range or of the wrong type.
  kParse,          ///< The content of a file or text violates its format.
  kIo,             ///< A file cannot be opened or read.
  kUnwritable,     ///< A file or standard output cannot be written.
};

/// "too_few_pairs" and so on: stable, for logs and JSON.
std::string_view ToString(ErrorCode code);

/// An error with its message: one line that is safe to print (PrintableLine), whatever names and
/// contents of files it quotes, and the lines that AddLine appends.
struct Error {
  Error() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): errors are written as {code, message}.
  Error(ErrorCode error_code, std::string text)
      : code(error_code), message(PrintableLine(std::move(text))) {}

  /// Appends a line of details, indented.
  void AddLine(std::string line) { message += "\n  " + PrintableLine(std::move(line)); }

  ErrorCode code{};
  std::string message;
};

/// A value or an error. No exception crosses the public API.
template <class T>
using Expected = tl::expected<T, Error>;

inline tl::unexpected<Error> MakeError(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

}  // namespace sextant

#define SEXTANT_CONCAT_INNER(a, b) a##b
#define SEXTANT_CONCAT(a, b) SEXTANT_CONCAT_INNER(a, b)

/// Returns the error of an Expected from the calling function, if there is one.
#define SEXTANT_RETURN_IF_ERROR(...)                                              \
  do {                                                                            \
    if (auto sextant_status = (__VA_ARGS__); !sextant_status) {                   \
      return tl::unexpected<::sextant::Error>(std::move(sextant_status.error())); \
    }                                                                             \
  } while (false)

/// SEXTANT_ASSIGN_OR_RETURN(const T x, F()): declares x as the value of the Expected that F
/// returns, or returns its error from the calling function. The declaration must not contain a
/// comma.
#define SEXTANT_ASSIGN_OR_RETURN(declaration, ...) \
  SEXTANT_ASSIGN_OR_RETURN_AS(SEXTANT_CONCAT(sextant_expected_, __LINE__), declaration, __VA_ARGS__)
#define SEXTANT_ASSIGN_OR_RETURN_AS(expected, declaration, ...)             \
  auto expected = (__VA_ARGS__);                                            \
  if (!expected) {                                                          \
    return tl::unexpected<::sextant::Error>(std::move((expected).error())); \
  }                                                                         \
  declaration = *std::move(expected)
