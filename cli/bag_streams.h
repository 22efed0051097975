// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/bag/bag.h"
#include "io/bag/messages.h"
#include "io/bag/pair_by_stamp.h"

namespace sextant::cli {

/// When each message of a topic was measured, in the order of the file.
struct BagStream {
  std::size_t topic = 0;
  std::vector<std::int64_t> stamps_ns;
};

/// A topic of scans and one of images, and which messages of them belong together.
struct BagPairing {
  std::size_t scans = 0;  ///< Indices of streams.
  std::size_t images = 0;
  StampPairs pairs;
};

struct BagStreams {
  std::vector<BagStream> streams;  ///< Of scans and images.
  std::vector<BagPairing> pairings;
};

/// Reads the stamps of all scans and images and pairs every topic of the ones with every topic of
/// the others.
Expected<BagStreams> ReadStreams(const Bag& bag, std::int64_t tolerance_ns);

/// "<number>_<stamp>", unique within its topic and in order.
std::string MessageName(std::size_t number, std::int64_t stamp_ns);

/// The topic as the name of a folder: "/camera/image_raw" is "camera_image_raw".
std::string FolderName(const std::string& topic);

/// Writes scans (PCD), images (encoded ones as they are, others as PNG), cameras (camera_info YAML,
/// where they differ from the one before) and pairs.csv into the folder, a folder for each topic.
/// Returns how many files. Errors: kIo; those of the messages.
Expected<int> ExtractBag(const Bag& bag, const BagStreams& streams, const std::string& folder);

}  // namespace sextant::cli
