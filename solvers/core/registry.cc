// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/registry.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/nearest_name.h"

namespace sextant {
namespace {

Expected<void> CheckOptions(const SolverEntry& entry, const SpecNode& node) {
  std::vector<std::string> known;
  for (const OptionDoc& doc : entry.options) known.push_back(doc.name);
  for (std::size_t i = 0; i < node.options.size(); ++i) {
    const std::string& name = node.options[i].first;
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string hint = known.empty() ? "it takes no options" : SuggestName(name, known);
      return MakeError(ErrorCode::kUnknownName,
                       fmt::format("solver '{}' has no option '{}'; {}", entry.name, name, hint));
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (node.options[j].first == name) {
        return MakeError(ErrorCode::kInvalidOption,
                         fmt::format("solver '{}': option '{}' is given twice", entry.name, name));
      }
    }
  }
  return {};
}

}  // namespace

const SolverEntry* SolverRegistry::Find(std::string_view name) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [name](const SolverEntry& e) { return e.name == name; });
  return found == entries_.end() ? nullptr : &*found;
}

Expected<SolverPtr> SolverRegistry::Make(std::string_view spec) const {
  return ParseSpec(spec).and_then([this](const SpecNode& node) { return Make(node); });
}

Expected<SolverPtr> SolverRegistry::Make(const SpecNode& node) const {
  const SolverEntry* entry = Find(node.name);
  if (entry == nullptr) {
    std::vector<std::string> known;
    for (const SolverEntry& e : entries_) known.push_back(e.name);
    return MakeError(ErrorCode::kUnknownName, fmt::format("unknown solver '{}'; {}", node.name,
                                                          SuggestName(node.name, known)));
  }
  const std::size_t wanted = entry->wraps_solver ? 1 : 0;
  if (node.inner.size() != wanted) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("solver '{}' takes {} solver in its parentheses, got {}; write {}", node.name,
                    wanted == 0 ? "no" : "one", node.inner.size(), entry->example));
  }
  SEXTANT_RETURN_IF_ERROR(CheckOptions(*entry, node));
  SolverArguments arguments{FormatSpec(node), node.options, nullptr};
  if (wanted == 1) {
    Expected<SolverPtr> inner = Make(node.inner.front());
    if (!inner) return inner;
    arguments.inner = std::move(*inner);
  }
  return entry->make(arguments);
}

}  // namespace sextant
