// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/pair_by_stamp.h"
#include "io/bag/bag.h"
#include "io/bag/messages.h"

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
  std::vector<BagStream> streams;  ///< The chosen topics of scans and of images.
  std::vector<BagPairing> pairings;
  std::size_t more_pairings = 0;  ///< Pairs of topics beyond kMaxPairings, which are left out.
};

/// The topics to read; an empty name chooses all of its kind.
struct StreamChoice {
  std::string image_topic{};
  std::string cloud_topic{};
};

inline constexpr std::size_t kMaxPairings = 100;

/// Reads the stamps of the chosen scans and images, and pairs every topic of scans with every topic
/// of images, the first kMaxPairings of them. Errors: those of Bag::Read and of the messages'
/// headers. Time: that of one Bag::Read, and O(n log n) in the messages for each pairing; memory:
/// 16 bytes for each message and pairing.
Expected<BagStreams> ReadStreams(const Bag& bag, std::int64_t tolerance_ns,
                                 const StreamChoice& choice = {});

}  // namespace sextant
