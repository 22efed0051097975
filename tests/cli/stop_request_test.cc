// SPDX-License-Identifier: Apache-2.0
#include "cli/capture/stop_request.h"

#include <gtest/gtest.h>

#include <csignal>

namespace sextant::cli {
namespace {

TEST(StopRequest, NotesTheFirstSignalAndRestoresTheHandler) {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_IGN);
  {
    const StopRequest stop;
    EXPECT_FALSE(stop.IsMade());
    raise(SIGTERM);  // It was ignored and stays so.
    EXPECT_FALSE(stop.IsMade());
    raise(SIGINT);
    EXPECT_TRUE(stop.IsMade());
    stop.Wait(std::chrono::hours(1));  // Returns at once.
    struct sigaction now {};
    sigaction(SIGINT, nullptr, &now);
    EXPECT_EQ(now.sa_handler, SIG_DFL);
  }
  {
    const StopRequest again;
    EXPECT_FALSE(again.IsMade());
  }
  struct sigaction after {};
  sigaction(SIGINT, nullptr, &after);
  EXPECT_EQ(after.sa_handler, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

}  // namespace
}  // namespace sextant::cli
