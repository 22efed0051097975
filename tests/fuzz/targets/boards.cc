// SPDX-License-Identifier: Apache-2.0
#include "io/boards/board_file.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(boards, bytes) {
  CheckRoundTrip(ParseBoards(bytes, "f"), ParseBoards,
                 [](const std::vector<Board>& boards) { return FormatBoards(boards); });
}

}  // namespace sextant::test
