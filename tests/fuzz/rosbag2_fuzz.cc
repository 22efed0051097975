// SPDX-License-Identifier: Apache-2.0
// SQLite wants a file with a path of its own: one that each input overwrites.
#include <fmt/core.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "io/bag/open_bytes.h"
#include "tests/fuzz/read_bag.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("sextant_fuzz_{}.db3", getpid());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  sextant::test::ReadWholeBag(sextant::OpenRosbag2Sqlite(path));
  std::filesystem::remove(path);
  return 0;
}
