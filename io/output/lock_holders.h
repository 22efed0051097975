// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace sextant {

/// "process 12", or "the processes 12 and 13": those of the lock file that still run. The file has
/// one number a line.
std::string DescribeHolders(int lock_file);

/// The same for a file of data, from the system's list of locks (flock); "another process" where
/// the list does not have it, as on network file systems.
std::string DescribeLockers(int file);

}  // namespace sextant
