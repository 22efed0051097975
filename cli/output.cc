// SPDX-License-Identifier: Apache-2.0
#include "cli/output.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "base/text/printable.h"
#include "io/text/text_file.h"

namespace sextant::cli {
namespace {

constexpr std::size_t kMaxPathBytes = 300;

}  // namespace

Expected<void> CheckOutputPath(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  if (!is_folder && access(folder.c_str(), W_OK | X_OK) == 0) return {};
  const std::string reason = is_folder ? "it is a folder" : std::generic_category().message(errno);
  return MakeError(ErrorCode::kIo, fmt::format("cannot write '{}': {}", path.string(), reason));
}

std::string WroteLine(const std::filesystem::path& path, std::string_view what) {
  return fmt::format("{}: {}\n", Printable(path.string(), kMaxPathBytes), what);
}

int Refuse(const char* command, const Error& error, int exit_code) {
  fmt::print(stderr, "sextant {}: {}\n", command, PrintableLines(error.message));
  return exit_code;
}

int Deliver(const char* command, const std::string& json_path, const std::string& text,
            const std::string& json, int exit_code) {
  if (json_path == "-") {
    fmt::print("{}", json);
    return exit_code;
  }
  fmt::print("{}", PrintableLines(text));
  if (json_path.empty()) return exit_code;
  if (Expected<void> ok = WriteFileAtomically(json_path, json); !ok) {
    return Refuse(command, ok.error());
  }
  return exit_code;
}

}  // namespace sextant::cli
