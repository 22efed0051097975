// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/random.h"

namespace sextant::test {

struct HostileInput {
  std::string name;
  std::string bytes;
};

/// Inputs that no reader accepts and that have broken readers: deep nesting, endless lines,
/// promises of a size that does not follow, control characters, bytes that are no UTF-8. Up to 1 MB
/// each.
const std::vector<HostileInput>& HostileInputs();

/// A copy with one to three faults: a part that is cut out, doubled or replaced by a hostile piece,
/// or a flipped bit.
std::string Damaged(std::string bytes, Random& random);

}  // namespace sextant::test
