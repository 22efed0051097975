// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <vector>

namespace sextant::test {

/// A background program that is ended with the test.
class BackgroundProgram {
 public:
  /// `environment`: "NAME=value", added to the test's own environment. Standard output and error go
  /// to the file `log`.
  BackgroundProgram(const std::vector<std::string>& command,
                    const std::vector<std::string>& environment, const std::string& log);
  ~BackgroundProgram();
  BackgroundProgram(const BackgroundProgram&) = delete;
  BackgroundProgram& operator=(const BackgroundProgram&) = delete;

  /// Ctrl-C.
  void Interrupt() const;

  /// Whether its main thread sleeps for a tenth of a second or has ended: it has handled what it
  /// got. False while it only waits for a processor.
  bool Rests() const;

  /// Waits for the end and returns the exit code; -1 after a timeout or if it is killed by a
  /// signal.
  int Wait(double seconds);

 private:
  pid_t pid_ = -1;
};

/// An X server without a screen (Xvfb), with mouse and keyboard from xdotool.
class VirtualDisplay {
 public:
  /// The reason to skip a test if one of both programs is not installed.
  static bool IsInstalled();
  static constexpr const char* kAbsent =
      "XVFB OR XDOTOOL ABSENT: install xvfb and xdotool to test windows";

  /// `folder` is for the log. Reports a failure to start with ADD_FAILURE.
  explicit VirtualDisplay(const std::string& folder);

  /// The environment variable, such as "DISPLAY=:7".
  const std::string& variable() const { return variable_; }
  /// Runs xdotool with these arguments and returns what it prints; at most 30 s.
  std::string Do(const std::string& arguments) const;

 private:
  std::string variable_;
  std::unique_ptr<BackgroundProgram> server_;
};

/// Sleeps for 50 ms.
void SleepBriefly();

/// Repeats the check until it holds or the timeout has passed; returns whether it holds.
template <class Condition>
bool Eventually(double seconds, Condition condition) {
  for (int i = 0; i < static_cast<int>(seconds / 0.05); ++i) {
    if (condition()) return true;
    SleepBriefly();
  }
  return condition();
}

}  // namespace sextant::test
