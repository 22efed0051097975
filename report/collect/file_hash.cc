// SPDX-License-Identifier: Apache-2.0
#include "report/collect/file_hash.h"

#include <sha256.h>
#include <sys/stat.h>

#include <array>
#include <fstream>

#include "base/call_files.h"

namespace sextant {
namespace {

std::string HexOf(SHA256_CTX& state) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
  SHA256_End(&state, digits.data());
  return digits.data();
}

}  // namespace

std::optional<std::string> HashOfFile(const std::filesystem::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  if (!NoteInput(status).empty()) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  SHA256_CTX state;
  SHA256_Init(&state);
  std::array<char, 1 << 16> block{};
  while (file) {
    file.read(block.data(), block.size());
    SHA256_Update(&state, reinterpret_cast<const std::uint8_t*>(block.data()),
                  static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) return std::nullopt;
  return HexOf(state);
}

std::string HashOfBytes(std::string_view bytes) {
  SHA256_CTX state;
  SHA256_Init(&state);
  SHA256_Update(&state, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  return HexOf(state);
}

}  // namespace sextant
