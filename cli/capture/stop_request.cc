// SPDX-License-Identifier: Apache-2.0
#include "cli/capture/stop_request.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <thread>

namespace sextant::cli {
namespace {

constexpr std::array<int, 3> kSignals = {SIGINT, SIGTERM, SIGHUP};
std::array<struct sigaction, kSignals.size()> g_before;
std::atomic<bool> g_is_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void RestoreSignals() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &g_before[i], nullptr);
}

void NoteRequest(int) {
  g_is_requested = true;
  RestoreSignals();
}

}  // namespace

StopRequest::StopRequest() {
  g_is_requested = false;
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], nullptr, &g_before[i]);
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    if (g_before[i].sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = NoteRequest;
    action.sa_flags = SA_RESTART;
    sigaction(kSignals[i], &action, nullptr);
  }
}

StopRequest::~StopRequest() {
  if (!g_is_requested) RestoreSignals();
}

bool StopRequest::IsMade() const { return g_is_requested; }

void StopRequest::Wait(std::chrono::milliseconds time) const {
  constexpr std::chrono::milliseconds kStep(100);
  const auto end = std::chrono::steady_clock::now() + time;
  for (auto now = std::chrono::steady_clock::now(); now < end && !IsMade();
       now = std::chrono::steady_clock::now()) {
    std::this_thread::sleep_for(
        std::min(kStep, std::chrono::ceil<std::chrono::milliseconds>(end - now)));
  }
}

}  // namespace sextant::cli
