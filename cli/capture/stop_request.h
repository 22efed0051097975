// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace sextant::cli {

/// While it lives, the first SIGINT (Ctrl-C), SIGTERM or SIGHUP is noted instead of ending the
/// process; the next one acts as before. Signals that are ignored stay so. One at a time.
class StopRequest {
 public:
  StopRequest();
  ~StopRequest();
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;

  bool IsMade() const;

  /// Returns after the time, or within a tenth of a second after a signal.
  void Wait(std::chrono::milliseconds time) const;
};

}  // namespace sextant::cli
