// SPDX-License-Identifier: Apache-2.0
#include "python/catalogue.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "base/spec.h"
#include "solvers/all/all_solvers.h"

namespace sextant::python {
namespace {

struct State {
  std::vector<SolverEntry> own;
  std::shared_ptr<const SolverRegistry> all = std::make_shared<SolverRegistry>(AllSolvers());
};

// Never destroyed: its functions are Python objects, which must not be released after the
// interpreter's end.
State& TheState() {
  static State* const state = new State();
  return *state;
}

Expected<void> CheckName(const std::string& name) {
  const Expected<SpecNode> spec = ParseSpec(name);
  if (!spec || spec->name != name) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("'{}' cannot name a solver: expected letters, digits, _ and .; "
                                 "give one with sextant.register(f, name=...)",
                                 name));
  }
  const SolverRegistry built_in = AllSolvers();
  const bool is_taken = std::ranges::any_of(
      built_in.entries(), [&](const SolverEntry& entry) { return entry.name == name; });
  if (!is_taken) return {};
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("{} is a solver of sextant; choose another name", name));
}

}  // namespace

std::shared_ptr<const SolverRegistry> Catalogue() { return TheState().all; }

Expected<void> Register(SolverEntry entry) {
  SEXTANT_RETURN_IF_ERROR(CheckName(entry.name));
  State& state = TheState();
  std::erase_if(state.own, [&](const SolverEntry& own) { return own.name == entry.name; });
  state.own.push_back(std::move(entry));
  auto all = std::make_shared<SolverRegistry>(AllSolvers());
  for (const SolverEntry& own : state.own) all->Add(own);
  state.all = std::move(all);
  return {};
}

}  // namespace sextant::python
