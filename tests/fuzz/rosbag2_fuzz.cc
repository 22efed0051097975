// SPDX-License-Identifier: Apache-2.0
// SQLite needs a file, which each input overwrites.
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
