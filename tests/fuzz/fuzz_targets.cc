// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/entry_point.h"

namespace sextant::test {

std::map<std::string, FuzzTarget>& FuzzTargets() {
  static std::map<std::string, FuzzTarget> targets;
  return targets;
}

}  // namespace sextant::test
