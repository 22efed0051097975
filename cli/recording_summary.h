// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calibrate/bag/bag_streams.h"

namespace sextant::cli {

/// The topics of the recording and, for each pairing of scans and images, how many pairs it has,
/// for people.
std::string DescribeRecording(const Bag& bag, const BagStreams& streams, const std::string& path,
                              double tolerance_s);

}  // namespace sextant::cli
