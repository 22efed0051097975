// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "io/bag/bag.h"
#include "io/bag/messages.h"
#include "tests/fuzz/check.h"

namespace sextant::test {

/// Decodes every message of a recording, if it was opened.
inline void ReadWholeBag(const Expected<std::unique_ptr<Bag>>& bag) {
  CheckOutcome(bag);
  if (!bag) return;
  std::vector<std::size_t> all((*bag)->topics().size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  CheckOutcome((*bag)->Read(all, [](const BagMessage& message) -> Expected<void> {
    CheckOutcome(DecodeHeader(message));
    CheckOutcome(DecodePointCloud(message));
    CheckOutcome(DecodeImage(message));
    CheckOutcome(DecodeEncodedImage(message));
    CheckOutcome(DecodeCameraInfo(message));
    return {};
  }));
}

}  // namespace sextant::test
