// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include "base/text/printable.h"
#include "io/output/standard_output.h"

namespace sextant::cli {
namespace {

constexpr auto kBetweenDrawings = std::chrono::milliseconds(200);
constexpr int kBarWidth = 30;

}  // namespace

Progress::Progress(std::string what, long total)
    : what_(std::move(what)),
      total_(total),
      visible_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      drawn_(start_) {}

Progress::~Progress() {
  if (visible_) DrawOnTerminal("\r\033[K");
}

void Progress::Set(long done) {
  if (!visible_) return;
  const std::unique_lock lock(drawing_, std::try_to_lock);
  if (!lock || std::chrono::steady_clock::now() - drawn_ < kBetweenDrawings) return;
  drawn_ = std::chrono::steady_clock::now();
  Draw(done);
}

void Progress::Draw(long done) {
  const double fraction = static_cast<double>(done) / static_cast<double>(total_);
  const double elapsed = std::chrono::duration<double>(drawn_ - start_).count();
  const int filled = static_cast<int>(fraction * kBarWidth);
  DrawOnTerminal(fmt::format("\r\033[K{} [{:#<{}}{:.<{}}] {:.0f} %, {:.0f} s left",
                             PrintableLine(what_), "", filled, "", kBarWidth - filled,
                             100.0 * fraction, elapsed * (1.0 - fraction) / fraction));
}

}  // namespace sextant::cli
