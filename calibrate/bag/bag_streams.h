// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "io/bag/bag.h"
#include "io/bag/messages.h"
#include "io/bag/pair_by_stamp.h"

namespace sextant {

/// The time stamps of one topic, in the order of the file.
struct BagStream {
  std::size_t topic = 0;
  std::vector<std::int64_t> stamps_ns;
};

/// A topic of scans, a topic of images, and the pairs of their messages.
struct BagPairing {
  std::size_t scans = 0;  ///< Index into BagStreams::streams, as is `images`.
  std::size_t images = 0;
  StampPairs pairs;
};

struct BagStreams {
  std::vector<BagStream> streams;  ///< All topics of scans and of images.
  std::vector<BagPairing> pairings;
};

/// Reads the stamps of all scans and images, and pairs every topic of scans with every topic of
/// images. Errors: those of Bag::Read and of the messages' headers.
Expected<BagStreams> ReadStreams(const Bag& bag, std::int64_t tolerance_ns);

}  // namespace sextant
