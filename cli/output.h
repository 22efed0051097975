// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"

namespace sextant::cli {

/// Exit codes, on which scripts rely.
inline constexpr int kAnswered = 0;
inline constexpr int kNoAnswer = 1;    ///< The input was read, and no solver answered.
inline constexpr int kWrongUse = 2;    ///< Wrong usage, or an input that cannot be read.
inline constexpr int kNotUsable = 3;   ///< Written, with the verdict NOT USABLE.
inline constexpr int kNotWritten = 4;  ///< A file or standard output could not be written.
inline constexpr int kFailed = 70;     ///< Out of memory, or an error in sextant itself.

/// kNotWritten for the error kUnwritable, else `exit_code`.
int ExitCodeOf(const Error& error, int exit_code = kWrongUse);

/// "<path>: <what>": the line about every file or folder that a command wrote.
std::string WroteLine(const std::filesystem::path& path, std::string_view what);

/// Prints "sextant <command>: <message>" on standard error. Returns ExitCodeOf the error.
int Refuse(const char* command, const Error& error, int exit_code = kWrongUse);

/// Prints a text that is not the result's: on standard error where --json is "-", as text and JSON
/// never share standard output.
void PrintBesideJson(const std::string& json_path, std::string_view text);

/// Prints the text, or writes the results to the file of --json. `json_path`: empty for none, "-"
/// for standard output. Returns `exit_code`, or that of Refuse if the file cannot be written.
int Deliver(const char* command, const std::string& json_path, const std::string& text,
            const std::string& json, int exit_code);

}  // namespace sextant::cli
