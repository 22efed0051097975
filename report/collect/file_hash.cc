// SPDX-License-Identifier: Apache-2.0
#include "report/collect/file_hash.h"

#include <sha256.h>
#include <sys/stat.h>

#include <array>
#include <fstream>
#include <map>
#include <mutex>

#include "base/call_files.h"

namespace sextant {
namespace {

std::string HexOf(SHA256_CTX& state) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
  SHA256_End(&state, digits.data());
  return digits.data();
}

std::optional<std::string> HashOfContent(const std::filesystem::path& path) {
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

// A hash, and what the file was before it was read.
struct KnownHash {
  off_t size = 0;
  timespec modified{};
  std::string hash{};

  bool IsOf(const struct stat& status) const {
    return size == status.st_size && modified.tv_sec == status.st_mtim.tv_sec &&
           modified.tv_nsec == status.st_mtim.tv_nsec;
  }
};

}  // namespace

std::optional<std::string> HashOfFile(const std::filesystem::path& path) {
  static std::mutex mutex;
  static std::map<std::string, KnownHash> known;
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  if (!NoteInput(status).empty()) return std::nullopt;
  {
    const std::scoped_lock lock(mutex);
    const auto found = known.find(path.string());
    if (found != known.end() && found->second.IsOf(status)) return found->second.hash;
  }
  std::optional<std::string> hash = HashOfContent(path);
  if (hash) {
    const std::scoped_lock lock(mutex);
    known[path.string()] = {status.st_size, status.st_mtim, *hash};
  }
  return hash;
}

std::string HashOfBytes(std::string_view bytes) {
  SHA256_CTX state;
  SHA256_Init(&state);
  SHA256_Update(&state, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  return HexOf(state);
}

}  // namespace sextant
