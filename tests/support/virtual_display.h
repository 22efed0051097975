// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <vector>

namespace sextant::test {

/// A program that runs beside the test; ended with it.
class BackgroundProgram {
 public:
  /// `environment`: "NAME=value" that the program gets besides the test's own. Its standard output
  /// and error go to the file `log`.
  BackgroundProgram(const std::vector<std::string>& command,
                    const std::vector<std::string>& environment, const std::string& log);
  ~BackgroundProgram();
  BackgroundProgram(const BackgroundProgram&) = delete;
  BackgroundProgram& operator=(const BackgroundProgram&) = delete;

  /// The exit code, once it ends; -1 if it does not within so many seconds or dies of a signal.
  int Wait(double seconds);

 private:
  pid_t pid_ = -1;
};

/// An X server without a screen (Xvfb), with mouse and keyboard from xdotool.
class VirtualDisplay {
 public:
  /// Whether both programs are installed; if not, a test skips with this reason.
  static bool IsInstalled();
  static constexpr const char* kAbsent =
      "XVFB OR XDOTOOL ABSENT: install xvfb and xdotool to test windows";

  /// `folder` for its log. Asserts by ADD_FAILURE that it starts.
  explicit VirtualDisplay(const std::string& folder);

  /// "DISPLAY=:7".
  const std::string& variable() const { return variable_; }
  /// Runs xdotool with these arguments and returns what it prints; at most 30 s.
  std::string Do(const std::string& arguments) const;

 private:
  std::string variable_;
  std::unique_ptr<BackgroundProgram> server_;
};

/// For 50 ms.
void SleepBriefly();

/// Tries until it holds, for at most so many seconds; whether it does.
template <class Condition>
bool Eventually(double seconds, Condition condition) {
  for (int i = 0; i < static_cast<int>(seconds / 0.05); ++i) {
    if (condition()) return true;
    SleepBriefly();
  }
  return condition();
}

}  // namespace sextant::test
