// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "base/error.h"
#include "io/results/rig_result.h"

namespace sextant::cli {

/// Where the result of a rig goes.
struct RigOutputs {
  std::string result_path{};
  std::string json_path{};    ///< See Deliver.
  std::string report_path{};  ///< The report in HTML; empty: not written.
};

/// kNoAnswer where the sensors' data has no answer, kWrongUse where the data itself is wrong.
int ExitCodeOfRig(const Error& error);

/// Writes a rig's result and its report, and prints it or its JSON (Deliver); prints the error
/// where there is none. Returns the exit code.
int DeliverRig(const char* command, const Expected<RigResult>& result, const RigOutputs& outputs);

}  // namespace sextant::cli
