// SPDX-License-Identifier: Apache-2.0
#include "cli/output.h"

#include <fmt/core.h>

#include "io/text/text_file.h"

namespace sextant::cli {

int Refuse(const char* command, const Error& error, int exit_code) {
  fmt::print(stderr, "sextant {}: {}\n", command, error.message);
  return exit_code;
}

int Deliver(const char* command, const std::string& json_path, const std::string& text,
            const std::string& json, int exit_code) {
  if (json_path == "-") {
    fmt::print("{}", json);
    return exit_code;
  }
  fmt::print("{}", text);
  if (json_path.empty()) return exit_code;
  if (Expected<void> ok = WriteFileAtomically(json_path, json); !ok) {
    return Refuse(command, ok.error());
  }
  return exit_code;
}

}  // namespace sextant::cli
