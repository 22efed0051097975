// SPDX-License-Identifier: Apache-2.0
#include "base/call_files.h"

#include <atomic>
#include <cassert>

namespace sextant {
namespace {

std::atomic<CallFiles*> g_current{nullptr};

constexpr const char* kIsInput = "it is an input of the same command; name another output";
constexpr const char* kIsOutput = "it is already an output of the same command; name another";

}  // namespace

CallFiles::CallFiles(bool may_overwrite) : may_overwrite_(may_overwrite) {
  assert(g_current == nullptr);
  g_current = this;
}

CallFiles::~CallFiles() { g_current = nullptr; }

CallFiles* CallFiles::Current() { return g_current; }

std::string CallFiles::AddInput(const FileId& file) {
  const std::scoped_lock lock(mutex_);
  const auto output = outputs_.find(file);
  if (output == outputs_.end()) {
    inputs_.insert(file);
    return {};
  }
  if (output->second.use.may_be_read || output->second.is_finished) return {};
  // A command may go on without this input, and must not replace it then.
  if (!output->second.is_begun) inputs_.insert(file);
  return "it is also an output of the same command; name another output";
}

std::string CallFiles::ClaimOutput(const FileId& file, OutputUse use) {
  const std::scoped_lock lock(mutex_);
  if (inputs_.contains(file) && !use.may_be_read) return kIsInput;
  return outputs_.emplace(file, Output{.use = use}).second ? "" : kIsOutput;
}

std::string CallFiles::BeginOutput(const FileId& file, OutputUse use) {
  const std::scoped_lock lock(mutex_);
  if (inputs_.contains(file) && !use.may_be_read) return kIsInput;
  Output& output = outputs_.emplace(file, Output{.use = use}).first->second;
  // Whoever replaces a file that this call has begun must know that it is its own.
  if (output.is_begun && !output.use.is_repeated && !use.is_repeated) return kIsOutput;
  output.is_begun = true;
  return {};
}

bool CallFiles::IsRecognised(const FileId& file) {
  const std::scoped_lock lock(mutex_);
  const auto output = outputs_.find(file);
  return output != outputs_.end() && output->second.use.is_recognised;
}

void CallFiles::FinishOutput(const FileId& before, const FileId& now) {
  const std::scoped_lock lock(mutex_);
  Output output = outputs_[before];
  output.is_finished = true;
  // The system may give the inode of a replaced file to the next one.
  outputs_.erase(before);
  inputs_.erase(now);
  outputs_[now] = output;
}

std::string NoteInput(const struct stat& status) {
  CallFiles* const files = CallFiles::Current();
  return files != nullptr ? files->AddInput(IdOf(status)) : "";
}

}  // namespace sextant
