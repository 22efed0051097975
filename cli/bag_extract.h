// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "calibrate/bag/bag_streams.h"

namespace sextant::cli {

/// "<number>_<stamp>", unique within its topic and in order.
std::string MessageName(std::size_t number, std::int64_t stamp_ns);

/// The topic as the name of a folder: "/camera/image_raw" is "camera_image_raw".
std::string FolderName(const std::string& topic);

/// Writes scans (PCD), images (encoded ones as they are, others as PNG), cameras (camera_info YAML,
/// where they differ from the one before) and pairs.csv into the folder, a folder for each topic.
/// Returns how many files. Errors: kIo; those of the messages.
Expected<int> ExtractBag(const Bag& bag, const BagStreams& streams, const std::string& folder);

}  // namespace sextant::cli
