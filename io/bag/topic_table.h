// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "io/bag/bag.h"

namespace sextant {

/// The index of the topic of this name and type; the topic is added if it is new.
inline std::size_t TopicIndex(std::vector<BagTopic>& topics, const std::string& name,
                              const std::string& type, MessageEncoding encoding) {
  const auto found = std::find_if(topics.begin(), topics.end(), [&](const BagTopic& topic) {
    return topic.name == name && topic.type == type;
  });
  if (found != topics.end()) return static_cast<std::size_t>(found - topics.begin());
  topics.push_back({.name = name, .type = type, .kind = MessageKindOf(type), .encoding = encoding});
  return topics.size() - 1;
}

/// For each topic, whether its index is among `indices`.
inline std::vector<bool> WantedTopics(const std::vector<BagTopic>& topics,
                                      const std::vector<std::size_t>& indices) {
  std::vector<bool> wanted(topics.size(), false);
  for (const std::size_t index : indices) wanted.at(index) = true;
  return wanted;
}

/// Counts one more message of the topic.
inline void CountMessage(BagTopic& topic, std::int64_t time_ns) {
  topic.first_ns = topic.count == 0 ? time_ns : std::min(topic.first_ns, time_ns);
  topic.last_ns = topic.count == 0 ? time_ns : std::max(topic.last_ns, time_ns);
  ++topic.count;
}

/// ROS 1's name of a type of ROS 2: "sensor_msgs/Image" for "sensor_msgs/msg/Image".
inline std::string Ros1TypeName(std::string type) {
  const std::size_t at = type.find("/msg/");
  if (at != std::string::npos) type.erase(at, 4);
  return type;
}

}  // namespace sextant
