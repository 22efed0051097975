// SPDX-License-Identifier: Apache-2.0
#include "io/bag/open_bytes.h"
#include "tests/fuzz/read_bag.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  sextant::test::ReadWholeBag(sextant::OpenMcap(bytes, "f", nullptr));
  return 0;
}
