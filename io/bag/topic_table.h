// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "io/bag/bag.h"

namespace sextant {

/// Finds topics by name and type, in constant time.
class TopicTable {
 public:
  /// The index of the topic; it is added to `topics` if it is new. Requires the same vector in
  /// every call.
  std::size_t IndexOf(const std::string& name, const std::string& type, MessageEncoding encoding,
                      std::vector<BagTopic>& topics) {
    const auto [place, is_new] = index_.emplace(KeyOf(name, type), topics.size());
    if (is_new) {
      topics.push_back(
          {.name = name, .type = type, .kind = MessageKindOf(type), .encoding = encoding});
    }
    return place->second;
  }

  /// None if it has not been added.
  std::optional<std::size_t> Find(const std::string& name, const std::string& type) const {
    const auto found = index_.find(KeyOf(name, type));
    return found == index_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  static std::string KeyOf(const std::string& name, const std::string& type) {
    return name + '\n' + type;
  }

  std::unordered_map<std::string, std::size_t> index_;
};

/// For each topic, whether its index is among `indices`.
inline std::vector<bool> WantedTopics(const std::vector<BagTopic>& topics,
                                      const std::vector<std::size_t>& indices) {
  std::vector<bool> wanted(topics.size(), false);
  for (const std::size_t index : indices) wanted.at(index) = true;
  return wanted;
}

/// Counts more messages of the topic, those from `first_ns` to `last_ns`.
inline void AddMessages(BagTopic& topic, std::size_t count, std::int64_t first_ns,
                        std::int64_t last_ns) {
  topic.first_ns = topic.count == 0 ? first_ns : std::min(topic.first_ns, first_ns);
  topic.last_ns = topic.count == 0 ? last_ns : std::max(topic.last_ns, last_ns);
  topic.count += count;
}
inline void CountMessage(BagTopic& topic, std::int64_t time_ns) {
  AddMessages(topic, 1, time_ns, time_ns);
}

inline std::size_t CountMessages(const std::vector<BagTopic>& topics) {
  return std::accumulate(topics.begin(), topics.end(), std::size_t{0},
                         [](std::size_t sum, const BagTopic& topic) { return sum + topic.count; });
}

/// The error for a recording that is cut before its first message; none if it has one.
Expected<void> RequireMessages(const std::string& file, const BagCut& cut,
                               const std::vector<BagTopic>& topics);

/// ROS 1's name of a type of ROS 2: "sensor_msgs/Image" for "sensor_msgs/msg/Image".
inline std::string Ros1TypeName(std::string type) {
  const std::size_t at = type.find("/msg/");
  if (at != std::string::npos) type.erase(at, 4);
  return type;
}

}  // namespace sextant
