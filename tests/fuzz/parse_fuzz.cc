// SPDX-License-Identifier: Apache-2.0
// Fuzzes one reader of text or bytes, which CMakeLists.txt selects.
#include SEXTANT_FUZZ_HEADER

#include "tests/fuzz/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  sextant::test::CheckOutcome(sextant::SEXTANT_FUZZ_PARSE(text, "f"));
  return 0;
}
