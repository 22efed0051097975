// SPDX-License-Identifier: Apache-2.0
#include "cli/output.h"

#include <fmt/core.h>

#include "base/text/path_text.h"
#include "io/output/output_file.h"
#include "io/output/standard_output.h"

namespace sextant::cli {

std::string WroteLine(const std::filesystem::path& path, std::string_view what) {
  return fmt::format("{}: {}\n", PathText(path), what);
}

int ExitCodeOf(const Error& error, int exit_code) {
  return error.code == ErrorCode::kUnwritable ? kNotWritten : exit_code;
}

int Refuse(const char* command, const Error& error, int exit_code) {
  PrintError("sextant {}: {}\n", command, error.message);
  return ExitCodeOf(error, exit_code);
}

void PrintBesideJson(const std::string& json_path, std::string_view text) {
  if (json_path == "-") return PrintErrorText(text);
  PrintText(text);
}

int Deliver(const char* command, const std::string& json_path, const std::string& text,
            const std::string& json, int exit_code) {
  if (json_path == "-") {
    PrintText(json);
    return exit_code;
  }
  const Expected<void> written =
      json_path.empty() ? Expected<void>() : WriteFileAtomically(json_path, json);
  PrintText(text);
  return written ? exit_code : Refuse(command, written.error());
}

}  // namespace sextant::cli
