// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "base/error.h"

namespace sextant {

struct ProcessOptions {
  std::string standard_input{};
  std::chrono::milliseconds timeout{60'000};
  /// Its output and its messages may each have so many bytes.
  std::size_t max_bytes = std::size_t{256} << 20;
};

/// What a program did before it ended by itself or by a signal.
struct ProcessEnd {
  int exit_code = 0;  ///< 128 + the number of the signal, if one ended it, as shells count.
  std::string out{};
  std::string err{};
};

/// Runs a program of the PATH and waits for it. No shell is involved: the arguments, of which the
/// first is the program, reach it as they are. Memory: input and outputs, held in memory twice.
///
/// Errors: kMissingData if there is no such program, kIo if it cannot be started, runs longer than
/// the timeout or writes more than `max_bytes` (it is then killed). A program that fails is no
/// error here: see `exit_code`.
Expected<ProcessEnd> RunProcess(const std::vector<std::string>& arguments,
                                const ProcessOptions& options = {});

}  // namespace sextant
