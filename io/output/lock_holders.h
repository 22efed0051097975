// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace sextant {

/// "process 12", or "the processes 12 and 13": those of the lock file that still run. The file has
/// one number a line.
std::string DescribeHolders(int lock_file);

}  // namespace sextant
