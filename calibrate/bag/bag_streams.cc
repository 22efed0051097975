// SPDX-License-Identifier: Apache-2.0
#include "calibrate/bag/bag_streams.h"

#include <algorithm>
#include <unordered_map>

namespace sextant {
namespace {

bool IsImage(MessageKind kind) {
  return kind == MessageKind::kImage || kind == MessageKind::kEncodedImage;
}

bool IsChosen(const BagTopic& topic, const StreamChoice& choice) {
  if (topic.kind == MessageKind::kPointCloud) {
    return choice.cloud_topic.empty() || topic.name == choice.cloud_topic;
  }
  return IsImage(topic.kind) && (choice.image_topic.empty() || topic.name == choice.image_topic);
}

// The chosen topics, without stamps.
std::vector<BagStream> ChosenStreams(const Bag& bag, const StreamChoice& choice) {
  std::vector<BagStream> streams;
  for (std::size_t i = 0; i < bag.topics().size(); ++i) {
    if (IsChosen(bag.topics()[i], choice)) streams.push_back({.topic = i, .stamps_ns = {}});
  }
  return streams;
}

void PairStreams(const Bag& bag, std::int64_t tolerance_ns, BagStreams& all) {
  std::vector<std::size_t> scans;
  std::vector<std::size_t> images;
  for (std::size_t i = 0; i < all.streams.size(); ++i) {
    (IsImage(bag.topics()[all.streams[i].topic].kind) ? images : scans).push_back(i);
  }
  const std::size_t pairings = scans.size() * images.size();
  for (std::size_t i = 0; i < std::min(pairings, kMaxPairings); ++i) {
    const std::size_t scan = scans[i / images.size()];
    const std::size_t image = images[i % images.size()];
    all.pairings.push_back(
        {scan, image,
         PairByStamp(all.streams[scan].stamps_ns, all.streams[image].stamps_ns, tolerance_ns)});
  }
  all.more_pairings = pairings - all.pairings.size();
}

}  // namespace

Expected<BagStreams> ReadStreams(const Bag& bag, std::int64_t tolerance_ns,
                                 const StreamChoice& choice) {
  BagStreams all{.streams = ChosenStreams(bag, choice), .pairings = {}};
  std::vector<std::size_t> topics;
  std::unordered_map<std::size_t, std::size_t> stream_of;
  for (std::size_t i = 0; i < all.streams.size(); ++i) {
    topics.push_back(all.streams[i].topic);
    stream_of[topics.back()] = i;
  }
  SEXTANT_RETURN_IF_ERROR(bag.Read(topics, [&](const BagMessage& message) -> Expected<void> {
    SEXTANT_ASSIGN_OR_RETURN(const MessageHeader header, DecodeHeader(message));
    all.streams[stream_of[message.topic_index]].stamps_ns.push_back(header.stamp_ns);
    return {};
  }));
  PairStreams(bag, tolerance_ns, all);
  return all;
}

}  // namespace sextant
