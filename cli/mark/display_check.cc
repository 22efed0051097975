// SPDX-License-Identifier: Apache-2.0
#include "cli/mark/display_check.h"

#include <fmt/core.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string>

namespace sextant::cli {
namespace {

constexpr const char* kAdvice =
    "run it on a desktop, through ssh -X, or on a display of its own: xvfb-run -s '-screen 0 "
    "1600x1000x24' sextant mark ...; --render FILE.png draws without a window";

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

// Whether a process listens on the socket of that name, in the file system or, if the first byte is
// zero, in the abstract namespace.
bool HasListener(const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (name.size() >= sizeof(address.sun_path)) return false;
  std::memcpy(address.sun_path, name.data(), name.size());
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  const bool ok = connect(fd, reinterpret_cast<const sockaddr*>(&address), length) == 0;
  close(fd);
  return ok;
}

// Displays of this machine are named ":0" or ":0.0". Whether others ("host:10.0") are reachable is
// left to the library.
bool IsUnreachable(const std::string& display) {
  if (!display.starts_with(':')) return false;
  const std::string number = display.substr(1, display.find('.') - 1);
  const std::string path = "/tmp/.X11-unix/X" + number;
  return !HasListener(path + '\0') && !HasListener('\0' + path);
}

}  // namespace

Expected<void> CheckDisplay() {
  const std::string display = Variable("DISPLAY");
  if (display.empty()) {
    if (!Variable("WAYLAND_DISPLAY").empty()) return {};
    return MakeError(
        ErrorCode::kIo,
        fmt::format("no display to open a window on (DISPLAY is not set): {}", kAdvice));
  }
  if (IsUnreachable(display)) {
    return MakeError(ErrorCode::kIo,
                     fmt::format("nothing answers on DISPLAY={}: {}", display, kAdvice));
  }
  return {};
}

}  // namespace sextant::cli
