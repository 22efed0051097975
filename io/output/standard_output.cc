// SPDX-License-Identifier: Apache-2.0
#include "io/output/standard_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <string>
#include <system_error>

#include "base/text/printable.h"

namespace sextant {
namespace {

std::mutex g_printing;
int g_failure = 0;  // errno of the first failure of standard output.

void NoteFailure() {
  if (g_failure == 0) g_failure = errno != 0 ? errno : EIO;
}

// A file in the wrong direction, so that each use fails as that of a closed stream does.
void FillIfClosed(int fd, int flags) {
  if (fcntl(fd, F_GETFD) >= 0 || errno != EBADF) return;
  // The lowest free number is given, and all below it are taken.
  const int ignored = open("/dev/null", flags);
  static_cast<void>(ignored);
}

}  // namespace

void PrepareStandardStreams() {
  FillIfClosed(STDIN_FILENO, O_WRONLY);
  FillIfClosed(STDOUT_FILENO, O_RDONLY);
  FillIfClosed(STDERR_FILENO, O_RDONLY);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

void PrintText(std::string_view foreign) {
  const std::string text = PrintableLines(std::string(foreign));
  const std::scoped_lock lock(g_printing);
  if (g_failure != 0) return;
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) NoteFailure();
}

void PrintErrorText(std::string_view text) { DrawOnTerminal(PrintableLines(std::string(text))); }

void DrawOnTerminal(std::string_view text) {
  const std::size_t ignored = std::fwrite(text.data(), 1, text.size(), stderr);
  static_cast<void>(ignored);
}

void FlushOutput() {
  const std::scoped_lock lock(g_printing);
  errno = 0;
  if (g_failure == 0 && std::fflush(stdout) != 0) NoteFailure();
}

Expected<void> FinishOutput() {
  const std::scoped_lock lock(g_printing);
  errno = 0;
  if (g_failure == 0 && std::fflush(stdout) != 0) NoteFailure();
  // Network file systems report a full disk only when a file is closed.
  const int copy = g_failure == 0 ? dup(STDOUT_FILENO) : -1;
  if (copy >= 0 && close(copy) != 0) NoteFailure();
  if (g_failure == 0 || g_failure == EPIPE) return {};
  return MakeError(ErrorCode::kUnwritable, fmt::format("cannot write to standard output: {}",
                                                       std::generic_category().message(g_failure)));
}

}  // namespace sextant
