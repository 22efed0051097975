// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace sextant {

/// The name of a file, in an open folder, that must not outlive the process: it is removed with the
/// object, and by RemoveTemporariesOnSignals. After SIGKILL it remains.
class Temporary {
 public:
  /// `folder` must stay open for as long as the object lives.
  Temporary(int folder, std::string name);
  ~Temporary();
  Temporary(Temporary&& other) noexcept;
  Temporary& operator=(Temporary&&) = delete;

  const std::string& name() const { return name_; }
  /// The file is not removed any more.
  void Keep();

 private:
  int folder_;
  std::string name_;  ///< Empty: nothing to remove.
  int slot_ = -1;     ///< In the table for signals; -1: the table was full.
};

/// ".<name>.<16 hexadecimal digits>.sxtmp", unpredictable; a long name is cut.
std::string TemporaryName(const std::string& name);
bool IsTemporaryName(std::string_view name);

/// On SIGINT, SIGTERM and SIGHUP, removes the files of all Temporary objects before the process
/// ends as it would have. Signals that are ignored stay so. For programs.
void RemoveTemporariesOnSignals();

}  // namespace sextant
