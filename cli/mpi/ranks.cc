// SPDX-License-Identifier: Apache-2.0
#include "cli/mpi/ranks.h"

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <numeric>
#include <thread>

namespace sextant::cli {
namespace {

constexpr auto kPollInterval = std::chrono::milliseconds(2);

// Waiting inside MPI keeps a core busy.
void WaitFor(MPI_Request request) {
  for (int done = 0;;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done != 0) return;
    std::this_thread::sleep_for(kPollInterval);
  }
}

std::vector<std::string> Gather(const std::string& own, int ranks) {
  const int size = static_cast<int>(own.size());
  std::vector<int> sizes(static_cast<std::size_t>(ranks));
  MPI_Request request{};
  MPI_Iallgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, MPI_COMM_WORLD, &request);
  WaitFor(request);
  std::vector<int> begins(sizes.size());
  std::exclusive_scan(sizes.begin(), sizes.end(), begins.begin(), 0);
  std::string all(static_cast<std::size_t>(begins.back() + sizes.back()), '\0');
  MPI_Iallgatherv(own.data(), size, MPI_CHAR, all.data(), sizes.data(), begins.data(), MPI_CHAR,
                  MPI_COMM_WORLD, &request);
  WaitFor(request);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    texts.push_back(
        all.substr(static_cast<std::size_t>(begins[i]), static_cast<std::size_t>(sizes[i])));
  }
  return texts;
}

}  // namespace

void Ranks::Abort(int exit_code) const {
  MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::abort();
}

Ranks::Ranks(int* argc, char*** argv) {
  int provided = 0;
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &count_);
  char name[MPI_MAX_PROCESSOR_NAME];
  int length = 0;
  MPI_Get_processor_name(name, &length);
  const std::string own(name, static_cast<std::size_t>(length));
  machines_ = Gather(own, count_);
  on_this_machine_ = static_cast<int>(std::count(machines_.begin(), machines_.end(), own));
}

Ranks::~Ranks() { MPI_Finalize(); }

Expected<void> Ranks::Agree(const Expected<void>& own) const {
  const std::string text = own ? "" : own.error().message;
  int code = own ? 0 : static_cast<int>(own.error().code) + 1;
  const std::vector<std::string> texts = Gather(text, count_);
  int worst = 0;
  MPI_Request request{};
  MPI_Iallreduce(&code, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD, &request);
  WaitFor(request);
  if (worst == 0) return {};
  const auto error_code = static_cast<ErrorCode>(worst - 1);
  const bool same = std::all_of(texts.begin(), texts.end(),
                                [&texts](const std::string& other) { return other == texts[0]; });
  if (same) return MakeError(error_code, texts[0]);
  std::vector<std::string> failures;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (texts[i].empty()) continue;
    failures.push_back(fmt::format("rank {} of {} on {}: {}", i, count_, machines_[i], texts[i]));
  }
  Error error(error_code, failures.front());
  for (std::size_t i = 1; i < failures.size(); ++i) error.AddLine(failures[i]);
  return tl::unexpected<Error>(std::move(error));
}

std::vector<std::uint64_t> Ranks::FromFirst(std::vector<std::uint64_t> words) const {
  std::uint64_t size = words.size();
  MPI_Request request{};
  MPI_Ibcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD, &request);
  WaitFor(request);
  words.resize(size);
  MPI_Ibcast(words.data(), static_cast<int>(size), MPI_UINT64_T, 0, MPI_COMM_WORLD, &request);
  WaitFor(request);
  return words;
}

}  // namespace sextant::cli
