// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "io/output/output_target.h"

namespace sextant {

/// A file that grows in place and is continued by a later run; its format must show where the last
/// run broke off. Only one process can have it open. A link at the target is never followed.
///
/// Errors: kInvalidOption if the call may not write the target, or another process writes it;
/// kUnwritable, with the system's reason.
class AppendedFile {
 public:
  /// Creates the file, or opens it at its end, whoever wrote it: the caller checks the content.
  static Expected<AppendedFile> Open(const std::filesystem::path& path);
  /// To be called before long work for a file that is opened after it: checks that it can be one,
  /// and that it is neither an input nor another output of the call.
  static Expected<void> Claim(const std::filesystem::path& path);

  std::uint64_t size() const { return size_; }
  /// The first bytes of the file, at most `count`.
  Expected<std::string> ReadBeginning(std::uint64_t count) const;
  /// The last bytes of the file, at most `count`.
  Expected<std::string> ReadEnd(std::uint64_t count) const;
  /// Cuts off all after the first `size` bytes.
  Expected<void> Truncate(std::uint64_t size);
  /// After an error (such as a full disk) the file is unchanged.
  Expected<void> Append(std::string_view bytes);
  /// Flushes all to the disk.
  Expected<void> Flush();

 private:
  explicit AppendedFile(OutputTarget target) : target_(std::move(target)) {}
  static Expected<OutputTarget> Target(const std::filesystem::path& path);
  Expected<std::string> Read(std::uint64_t begin, std::uint64_t count) const;
  Expected<void> Lock();
  tl::unexpected<Error> Failed() const;

  OutputTarget target_;
  Descriptor file_;
  std::uint64_t size_ = 0;
};

}  // namespace sextant
