// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/options.h"
#include "base/spec.h"
#include "solvers/core/solver.h"

namespace sextant {

/// The arguments of a factory: the canonical name, options with checked names, the inner solver.
struct SolverArguments {
  std::string name;
  OptionValues options;
  SolverPtr inner;  ///< Null unless the entry wraps a solver.
};

/// One entry of the catalogue of solvers.
struct SolverEntry {
  std::string name;
  std::string summary;    ///< What it minimises or does, in one line.
  std::string needs;      ///< Text such as "3 or more 3D-3D pairs, not collinear".
  std::string reference;  ///< Source of the method.
  std::string example;    ///< A valid spec.
  bool wraps_solver = false;
  std::vector<OptionDoc> options = {};
  std::function<Expected<SolverPtr>(const SolverArguments&)> make;
};

/// Solvers by name. Filled explicitly (BuiltinSolvers, and AddOpenCvSolvers where built).
class SolverRegistry {
 public:
  void Add(SolverEntry entry) { entries_.push_back(std::move(entry)); }
  const std::vector<SolverEntry>& entries() const { return entries_; }

  /// Errors: kParse, kUnknownName (suggests the nearest known name), kInvalidOption.
  Expected<SolverPtr> Make(std::string_view spec) const;
  Expected<SolverPtr> Make(const SpecNode& node) const;

 private:
  const SolverEntry* Find(std::string_view name) const;

  std::vector<SolverEntry> entries_;
};

}  // namespace sextant
