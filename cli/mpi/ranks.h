// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"

namespace sextant::cli {

/// The processes that mpirun started. One object a process, for as long as it uses MPI. Whoever
/// waits for the others sleeps, so that a rank that is done takes no core from those that are not.
class Ranks {
 public:
  Ranks(int* argc, char*** argv);
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return rank_; }
  int count() const { return count_; }
  bool is_first() const { return rank_ == 0; }
  /// How many of them share this machine, this one among them.
  int on_this_machine() const { return on_this_machine_; }

  /// Returns on every rank once all have called it, and the same on all: nothing where all
  /// succeeded, otherwise what failed on which of them.
  Expected<void> Agree(const Expected<void>& own) const;

  /// Those of the first rank, on all. All must call it.
  std::vector<std::uint64_t> FromFirst(std::vector<std::uint64_t> words) const;

 private:
  int rank_ = 0;
  int count_ = 1;
  int on_this_machine_ = 1;
  std::vector<std::string> machines_;  ///< By rank.
};

}  // namespace sextant::cli
