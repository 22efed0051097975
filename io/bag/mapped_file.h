// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>

#include "base/error.h"

namespace sextant {

/// The bytes of a regular file, mapped so that the system loads them on access: recordings may be
/// larger than memory. The file must not be truncated while it is mapped.
class MappedFile {
 public:
  /// Error: kIo, with the path and the system's reason.
  static Expected<std::shared_ptr<const MappedFile>> Open(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view bytes() const { return {data_, size_}; }

 private:
  MappedFile(const char* data, std::size_t size) : data_(data), size_(size) {}

  const char* data_;
  std::size_t size_;
};

}  // namespace sextant
