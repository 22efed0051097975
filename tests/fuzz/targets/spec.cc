// SPDX-License-Identifier: Apache-2.0
#include "base/spec.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(spec, bytes) {
  CheckOutcome(ParseSpec(bytes));
  const Expected<std::vector<SpecNode>> specs = ParseSpecList(bytes);
  CheckOutcome(specs);
  if (!specs) return;
  for (const SpecNode& spec : *specs) {
    const std::string text = FormatSpec(spec);
    const Expected<SpecNode> again = ParseSpec(text);
    if (!again || FormatSpec(*again) != text) Fault("a spec that does not read back: " + text);
  }
}

}  // namespace sextant::test
