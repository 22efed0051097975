// SPDX-License-Identifier: Apache-2.0
#include "support/display/virtual_display.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>

#include "base/process/run_process.h"

namespace sextant::test {
namespace {

bool IsOnPath(const std::string& program) {
  const Expected<ProcessEnd> end = RunProcess({"/bin/sh", "-c", "command -v " + program});
  return end && end->exit_code == 0;
}

}  // namespace

void SleepBriefly() { std::this_thread::sleep_for(std::chrono::milliseconds(50)); }

BackgroundProgram::BackgroundProgram(const std::vector<std::string>& command,
                                     const std::vector<std::string>& environment,
                                     const std::string& log) {
  std::vector<std::string> words = {"env"};
  words.insert(words.end(), environment.begin(), environment.end());
  words.insert(words.end(), command.begin(), command.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_ = fork();
  if (pid_ != 0) return;
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int nothing = open("/dev/null", O_RDONLY);
  dup2(nothing, STDIN_FILENO);
  dup2(file, STDOUT_FILENO);
  dup2(file, STDERR_FILENO);
  execvp(arguments[0], arguments.data());
  _exit(127);
}

BackgroundProgram::~BackgroundProgram() {
  if (pid_ <= 0) return;
  kill(pid_, SIGTERM);
  if (Wait(5.0) == -1 && pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
}

void BackgroundProgram::Interrupt() const {
  if (pid_ > 0) kill(pid_, SIGINT);
}

bool BackgroundProgram::Rests() const {
  for (int i = 0; i < 10; ++i) {
    std::ifstream stream("/proc/" + std::to_string(pid_) + "/stat");
    std::string text;
    std::getline(stream, text);
    // The state is the letter after the name in parentheses.
    const std::size_t state = text.rfind(')') + 2;
    if (state < text.size() && text[state] != 'S' && text[state] != 'Z') return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

int BackgroundProgram::Wait(double seconds) {
  int status = 0;
  const bool ended = Eventually(seconds, [&] { return waitpid(pid_, &status, WNOHANG) == pid_; });
  if (!ended) return -1;
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool VirtualDisplay::IsInstalled() { return IsOnPath("Xvfb") && IsOnPath("xdotool"); }

VirtualDisplay::VirtualDisplay(const std::string& folder) {
  // The server chooses a free display number and writes it to its standard output.
  const std::string log = folder + "/display";
  server_ = std::make_unique<BackgroundProgram>(
      std::vector<std::string>{"Xvfb", "-displayfd", "1", "-nolisten", "tcp", "-screen", "0",
                               "1400x900x24"},
      std::vector<std::string>{}, log);
  const bool started = Eventually(20.0, [&] {
    std::ifstream stream(log);
    for (std::string line; std::getline(stream, line) && !stream.eof();) {
      if (line.empty() || line.find_first_not_of("0123456789") != std::string::npos) continue;
      variable_ = "DISPLAY=:" + line;
      return true;
    }
    return false;
  });
  if (!started) ADD_FAILURE() << "Xvfb did not start; see " << log;
}

std::string VirtualDisplay::Do(const std::string& arguments) const {
  const std::string command = variable_ + " timeout 30 xdotool " + arguments;
  const Expected<ProcessEnd> end = RunProcess({"/bin/sh", "-c", command});
  return end ? end->out : std::string();
}

}  // namespace sextant::test
