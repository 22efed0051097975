// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"

namespace sextant::cli {

/// The processes that mpirun started. One object per process, for as long as it uses MPI. A rank
/// that waits for others sleeps, so that it takes no core from those that still run.
class Ranks {
 public:
  Ranks(int* argc, char*** argv);
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return rank_; }
  int count() const { return count_; }
  bool is_first() const { return rank_ == 0; }
  /// The number of ranks on this machine, including this one.
  int on_this_machine() const { return on_this_machine_; }

  /// Ends all ranks.
  [[noreturn]] void Abort(int exit_code) const;

  /// Returns on every rank once all have called it, with the same value on all: no error if all
  /// succeeded, otherwise the errors with their ranks.
  Expected<void> Agree(const Expected<void>& own) const;

  /// Returns the words of the first rank on all ranks. All must call it.
  std::vector<std::uint64_t> FromFirst(std::vector<std::uint64_t> words) const;

 private:
  int rank_ = 0;
  int count_ = 1;
  int on_this_machine_ = 1;
  std::vector<std::string> machines_;  ///< Indexed by rank.
};

}  // namespace sextant::cli
