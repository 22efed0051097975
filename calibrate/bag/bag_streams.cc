// SPDX-License-Identifier: Apache-2.0
#include "calibrate/bag/bag_streams.h"

#include <map>

namespace sextant {
namespace {

bool IsImage(MessageKind kind) {
  return kind == MessageKind::kImage || kind == MessageKind::kEncodedImage;
}

}  // namespace

Expected<BagStreams> ReadStreams(const Bag& bag, std::int64_t tolerance_ns) {
  BagStreams all;
  std::vector<std::size_t> topics;
  std::map<std::size_t, std::size_t> stream_of;
  for (std::size_t i = 0; i < bag.topics().size(); ++i) {
    const MessageKind kind = bag.topics()[i].kind;
    if (kind != MessageKind::kPointCloud && !IsImage(kind)) continue;
    topics.push_back(i);
    stream_of[i] = all.streams.size();
    all.streams.push_back({.topic = i, .stamps_ns = {}});
  }
  SEXTANT_RETURN_IF_ERROR(bag.Read(topics, [&](const BagMessage& message) -> Expected<void> {
    SEXTANT_ASSIGN_OR_RETURN(const MessageHeader header, DecodeHeader(message));
    all.streams[stream_of[message.topic_index]].stamps_ns.push_back(header.stamp_ns);
    return {};
  }));
  for (std::size_t scans = 0; scans < all.streams.size(); ++scans) {
    if (bag.topics()[all.streams[scans].topic].kind != MessageKind::kPointCloud) continue;
    for (std::size_t images = 0; images < all.streams.size(); ++images) {
      if (!IsImage(bag.topics()[all.streams[images].topic].kind)) continue;
      all.pairings.push_back(
          {scans, images,
           PairByStamp(all.streams[scans].stamps_ns, all.streams[images].stamps_ns, tolerance_ns)});
    }
  }
  return all;
}

}  // namespace sextant
