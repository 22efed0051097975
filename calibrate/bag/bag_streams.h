// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "io/bag/bag.h"
#include "io/bag/messages.h"
#include "io/bag/pair_by_stamp.h"

namespace sextant {

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

}  // namespace sextant
