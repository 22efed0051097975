// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <numeric>
#include <vector>

#include "io/bag/bag.h"
#include "io/bag/messages.h"
#include "tests/fuzz/cloud.h"

namespace sextant::test {

/// Decodes a message as each kind, its own or not.
inline void DecodeAsEverything(const BagMessage& message) {
  CheckOutcome(DecodeHeader(message));
  const Expected<CloudMessage> cloud = DecodePointCloud(message);
  CheckOutcome(cloud);
  if (cloud) CheckCloud(cloud->cloud);
  CheckOutcome(DecodeImage(message));
  CheckOutcome(DecodeEncodedImage(message));
  CheckOutcome(DecodeCameraInfo(message));
}

/// Decodes every message of a recording, if it was opened.
inline void ReadRecording(const Expected<std::unique_ptr<Bag>>& bag) {
  CheckOutcome(bag);
  if (!bag) return;
  std::vector<std::size_t> all((*bag)->topics().size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  CheckOutcome((*bag)->Read(all, [](const BagMessage& message) -> Expected<void> {
    DecodeAsEverything(message);
    return {};
  }));
}

}  // namespace sextant::test
