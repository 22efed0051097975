// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>

#include "base/error.h"
#include "cli/capture/local_page.h"

namespace sextant::cli {

/// Shows one page to browsers on this machine, from a thread of its own. It listens on 127.0.0.1
/// alone; see AnswerLocally for what it answers. At most kMaxConnections at a time, each of which
/// has 30 s for a request of at most 8 KiB.
class PageServer {
 public:
  static constexpr int kMaxConnections = 64;

  /// Port 0: a free one. Errors: kInvalidOption for a port that cannot be used.
  static Expected<std::unique_ptr<PageServer>> Start(std::uint16_t port);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  std::uint16_t port() const;

  /// What requests get from now on.
  void Show(ServedPage page);

  /// Whether an open page has asked for the state in so much time.
  bool WasAskedWithin(std::chrono::seconds time) const;

 private:
  class Impl;
  explicit PageServer(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant::cli
