// SPDX-License-Identifier: Apache-2.0
#include "base/process/run_process.h"

#include <fmt/core.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <functional>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

namespace sextant {
namespace {

tl::unexpected<Error> SystemFailure(const std::string& program, const char* what, int number) {
  return MakeError(
      number == ENOENT ? ErrorCode::kMissingData : ErrorCode::kIo,
      fmt::format("{}: {}: {}", program, what, std::generic_category().message(number)));
}

// A file in memory. A stream of the program in a file, unlike one in a pipe, needs no reader while
// the program runs, and cannot break.
class MemoryFile {
 public:
  MemoryFile() : fd_(memfd_create("sextant", MFD_CLOEXEC)) {}
  ~MemoryFile() {
    if (fd_ >= 0) close(fd_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int fd() const { return fd_; }

  // Leaves the position at the beginning, where the program reads on.
  bool Fill(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t written = write(fd_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return false;
      text.remove_prefix(static_cast<std::size_t>(written));
    }
    return lseek(fd_, 0, SEEK_SET) == 0;
  }

  std::size_t size() const {
    struct stat status {};
    return fstat(fd_, &status) == 0 ? static_cast<std::size_t>(status.st_size) : 0;
  }

  // None if it cannot be read.
  std::optional<std::string> Content() const {
    std::string text(size(), '\0');
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t got =
          pread(fd_, text.data() + done, text.size() - done, static_cast<off_t>(done));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return std::nullopt;
      done += static_cast<std::size_t>(got);
    }
    return text;
  }

 private:
  int fd_;
};

// Starts the program with the three files as its standard streams; returns the error's number.
int Spawn(std::vector<std::string> arguments, const MemoryFile& in, const MemoryFile& out,
          const MemoryFile& err, pid_t& pid) {
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.fd(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out.fd(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.fd(), STDERR_FILENO);
  const int error = posix_spawnp(&pid, words[0], &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

// The status of the ended program; none at the timeout, or where it writes too much: then the
// program is dead too. What it writes is in memory, so it is looked at while it runs.
std::optional<int> WaitFor(pid_t pid, std::chrono::milliseconds timeout,
                           const std::function<bool()>& writes_too_much) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  std::chrono::milliseconds pause{1};
  int status = 0;
  while (true) {
    const pid_t ended = waitpid(pid, &status, WNOHANG);
    if (ended == pid) return status;
    if (ended < 0 && errno != EINTR) return std::nullopt;
    if (std::chrono::steady_clock::now() > end || writes_too_much()) break;
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, std::chrono::milliseconds(5));
  }
  kill(pid, SIGKILL);
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return std::nullopt;
}

}  // namespace

Expected<ProcessEnd> RunProcess(const std::vector<std::string>& arguments,
                                const ProcessOptions& options) {
  const std::string& program = arguments.front();
  const MemoryFile in;
  const MemoryFile out;
  const MemoryFile err;
  if (in.fd() < 0 || out.fd() < 0 || err.fd() < 0 || !in.Fill(options.standard_input)) {
    return SystemFailure(program, "cannot hold its streams in memory", errno);
  }
  pid_t pid = -1;
  if (const int error = Spawn(arguments, in, out, err, pid); error != 0) {
    return SystemFailure(program, "cannot be started", error);
  }
  const auto writes_too_much = [&] {
    return out.size() > options.max_bytes || err.size() > options.max_bytes;
  };
  const std::optional<int> status = WaitFor(pid, options.timeout, writes_too_much);
  if (writes_too_much()) {
    return MakeError(ErrorCode::kIo,
                     fmt::format("{}: it wrote more than {} bytes", program, options.max_bytes));
  }
  if (!status) {
    return MakeError(ErrorCode::kIo,
                     fmt::format("{}: it was stopped after {} s without an end", program,
                                 std::chrono::duration<double>(options.timeout).count()));
  }
  std::optional<std::string> out_text = out.Content();
  std::optional<std::string> err_text = err.Content();
  if (!out_text || !err_text) return SystemFailure(program, "cannot read what it wrote", errno);
  return ProcessEnd{
      .exit_code = WIFEXITED(*status) ? WEXITSTATUS(*status) : 128 + WTERMSIG(*status),
      .out = std::move(*out_text),
      .err = std::move(*err_text)};
}

}  // namespace sextant
