// SPDX-License-Identifier: Apache-2.0
#include "io/bag/messages.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/recording.h"

namespace sextant::test {

// The first byte is 1 for ROS 1, anything else for CDR; the message follows.
SEXTANT_FUZZ_TARGET(bag_message, bytes) {
  if (bytes.empty()) return;
  BagTopic topic;
  topic.name = "/t";
  topic.encoding = bytes.front() == 1 ? MessageEncoding::kRos1 : MessageEncoding::kCdr;
  bytes.remove_prefix(1);
  DecodeAsEverything({.topic = &topic, .data = bytes});
}

}  // namespace sextant::test
