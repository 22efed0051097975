// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include "base/text/printable.h"
#include "io/output/standard_output.h"

namespace sextant::cli {
namespace {

constexpr auto kBeforeFirst = std::chrono::milliseconds(500);
constexpr auto kBetweenDrawings = std::chrono::milliseconds(200);
constexpr int kBarWidth = 30;

}  // namespace

Progress::Progress() : visible_(isatty(STDERR_FILENO) == 1), start_(Clock::now()), drawn_(start_) {}

Progress::~Progress() { Clear(); }

void Progress::Report(std::string_view stage, std::size_t done, std::size_t total) {
  if (!visible_) return;
  const bool is_end = done == 0 || done == total;
  // A step that meets another one's drawing is not worth a wait; the ends of a stage are.
  std::unique_lock lock(mutex_, std::defer_lock);
  if (is_end) {
    lock.lock();
  } else if (!lock.try_lock()) {
    return;
  }
  if (stage != stage_) {
    Clear();
    stage_ = stage;
    start_ = Clock::now();
  }
  if (done >= total) {
    Clear();
    stage_.clear();
    return;
  }
  const Clock::time_point now = Clock::now();
  if (now - start_ < kBeforeFirst || now - drawn_ < kBetweenDrawings) return;
  drawn_ = now;
  Draw(done, total);
}

void Progress::Draw(std::size_t done, std::size_t total) {
  const double fraction = static_cast<double>(done) / static_cast<double>(total);
  const double elapsed = std::chrono::duration<double>(drawn_ - start_).count();
  const int filled = static_cast<int>(fraction * kBarWidth);
  std::string line = fmt::format("\r\033[K{} [{:#<{}}{:.<{}}] {:.0f} %", PrintableLine(stage_), "",
                                 filled, "", kBarWidth - filled, 100.0 * fraction);
  if (done > 0) line += fmt::format(", {:.0f} s left", elapsed * (1.0 - fraction) / fraction);
  DrawOnTerminal(line);
  is_drawn_ = true;
}

void Progress::Clear() {
  if (is_drawn_) DrawOnTerminal("\r\033[K");
  is_drawn_ = false;
}

}  // namespace sextant::cli
