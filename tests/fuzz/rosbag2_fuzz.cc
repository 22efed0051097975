// SPDX-License-Identifier: Apache-2.0
// SQLite wants a file: one in memory.
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "io/bag/open_bytes.h"
#include "tests/fuzz/read_bag.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int fd = memfd_create("rosbag2", 0);
  if (fd < 0 || write(fd, data, size) != static_cast<ssize_t>(size)) std::abort();
  sextant::test::ReadWholeBag(sextant::OpenRosbag2Sqlite(fmt::format("/proc/self/fd/{}", fd)));
  close(fd);
  return 0;
}
