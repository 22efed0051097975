// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "base/error.h"
#include "io/results/rig_result.h"

namespace sextant::cli {

/// Writes a rig's result, and prints it or its JSON (Deliver); prints the error where there is
/// none. Returns the exit code.
int DeliverRig(const char* command, const Expected<RigResult>& result, const std::string& out_path,
               const std::string& json_path);

}  // namespace sextant::cli
