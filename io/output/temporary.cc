// SPDX-License-Identifier: Apache-2.0
#include "io/output/temporary.h"

#include <fmt/core.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <utility>

namespace sextant {
namespace {

// A signal handler may neither allocate nor lock, so the names are in a table of fixed size.
constexpr std::size_t kMaxName = 256;
enum SlotState : int { kFree, kChanging, kUsed };
struct Slot {
  std::atomic<int> state{kFree};
  int folder = -1;
  std::array<char, kMaxName> name{};
};
std::array<Slot, 256> g_slots;

int TakeSlot(int folder, const std::string& name) {
  if (name.size() >= kMaxName) return -1;
  for (std::size_t i = 0; i < g_slots.size(); ++i) {
    int expected = kFree;
    if (!g_slots[i].state.compare_exchange_strong(expected, kChanging)) continue;
    g_slots[i].folder = folder;
    g_slots[i].name.fill('\0');
    std::copy(name.begin(), name.end(), g_slots[i].name.begin());
    g_slots[i].state = kUsed;
    return static_cast<int>(i);
  }
  return -1;
}

void RemoveAndEnd(int signal) {
  for (const Slot& slot : g_slots) {
    if (slot.state == kUsed) unlinkat(slot.folder, slot.name.data(), 0);
  }
  // The handler was reset when it was called: the process ends as without it.
  raise(signal);
}

constexpr std::string_view kEnding = ".sxtmp";
constexpr std::size_t kDigits = 16;

}  // namespace

Temporary::Temporary(int folder, std::string name)
    : folder_(folder), name_(std::move(name)), slot_(TakeSlot(folder_, name_)) {}

Temporary::~Temporary() {
  if (name_.empty()) return;
  unlinkat(folder_, name_.c_str(), 0);
  Keep();
}

Temporary::Temporary(Temporary&& other) noexcept
    : folder_(other.folder_),
      name_(std::exchange(other.name_, {})),
      slot_(std::exchange(other.slot_, -1)) {}

void Temporary::Keep() {
  name_.clear();
  if (slot_ >= 0) g_slots[static_cast<std::size_t>(std::exchange(slot_, -1))].state = kFree;
}

std::string TemporaryName(const std::string& name) {
  std::uint64_t number = 0;
  // Fails only where the kernel has no source of randomness; O_EXCL then still protects.
  if (getrandom(&number, sizeof number, 0) != sizeof number)
    number = static_cast<unsigned>(getpid());
  return fmt::format(".{}.{:016x}{}", name.substr(0, 200), number, kEnding);
}

bool IsTemporaryName(std::string_view name) {
  if (name.size() < kDigits + kEnding.size() + 2 || !name.starts_with('.')) return false;
  if (!name.ends_with(kEnding)) return false;
  name.remove_suffix(kEnding.size());
  const std::string_view digits = name.substr(name.size() - kDigits);
  return name[name.size() - kDigits - 1] == '.' &&
         digits.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

void RemoveTemporariesOnSignals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    if (sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = RemoveAndEnd;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
    sigaction(signal, &action, nullptr);
  }
}

}  // namespace sextant
