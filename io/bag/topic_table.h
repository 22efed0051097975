// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "io/bag/bag.h"

namespace sextant {

/// The index of the topic of this name and type, which is added where it is new.
inline std::size_t TopicIndex(std::vector<BagTopic>& topics, const std::string& name,
                              const std::string& type, MessageEncoding encoding) {
  const auto found = std::find_if(topics.begin(), topics.end(), [&](const BagTopic& topic) {
    return topic.name == name && topic.type == type;
  });
  if (found != topics.end()) return static_cast<std::size_t>(found - topics.begin());
  topics.push_back({.name = name, .type = type, .kind = MessageKindOf(type), .encoding = encoding});
  return topics.size() - 1;
}

/// One more message of the topic.
inline void CountMessage(BagTopic& topic, std::int64_t time_ns) {
  topic.first_ns = topic.count == 0 ? time_ns : std::min(topic.first_ns, time_ns);
  topic.last_ns = topic.count == 0 ? time_ns : std::max(topic.last_ns, time_ns);
  ++topic.count;
}

/// "sensor_msgs/msg/Image" as ROS 1 writes it: "sensor_msgs/Image".
inline std::string Ros1TypeName(std::string type) {
  const std::size_t at = type.find("/msg/");
  if (at != std::string::npos) type.erase(at, 4);
  return type;
}

}  // namespace sextant
