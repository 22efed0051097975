// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/core.h>

#include <string_view>
#include <utility>

#include "base/error.h"

// Standard output and standard error of a program. Printing never throws: what standard output
// could not take is reported once, by FinishOutput; what standard error could not take is dropped.
namespace sextant {

/// To be called first in main: a stream that is closed does not become the next file that is
/// opened. A closed pipe and a limit of the size of files are errors of writing instead of the end
/// of the process.
void PrepareStandardStreams();

/// Both print PrintableLines of the text: names in it may come from anywhere.
void PrintText(std::string_view text);
void PrintErrorText(std::string_view text);

/// The text on standard error as it is, with its control sequences: for progress bars.
void DrawOnTerminal(std::string_view text);

template <class... Values>
void Print(fmt::format_string<Values...> format, Values&&... values) {
  PrintText(fmt::format(format, std::forward<Values>(values)...));
}

template <class... Values>
void PrintError(fmt::format_string<Values...> format, Values&&... values) {
  PrintErrorText(fmt::format(format, std::forward<Values>(values)...));
}

/// Shows what was printed so far, for commands that run until they are stopped. A failure is
/// reported by FinishOutput.
void FlushOutput();

/// Flushes standard output. Error: kUnwritable if any of what was printed is lost. If its reader
/// has closed the pipe, that is no error: the reader wanted no more.
Expected<void> FinishOutput();

}  // namespace sextant
