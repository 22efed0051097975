// SPDX-License-Identifier: Apache-2.0
// Parses the solvers of an experiment file.
#include <fmt/core.h>

#include "eval/experiment/definition/experiment_parser.h"
#include "io/text/number_text.h"

namespace sextant {

// "all" expands to every plain solver and to every combinator around the closed forms of both kinds
// of pairs.
std::vector<std::string> ExperimentParser::SpecsOf(const std::string& text) const {
  if (text != "all") return {text};
  std::vector<std::string> specs;
  for (const SolverEntry& entry : registry_.entries()) {
    if (!entry.wraps_solver) {
      specs.push_back(entry.name);
    } else {
      for (const char* inner : {"kabsch", "epnp"}) {
        specs.push_back(fmt::format("{}({})", entry.name, inner));
      }
    }
  }
  return specs;
}

void ExperimentParser::AddSolvers(const std::string& text, int line,
                                  std::vector<SolverPtr>& solvers) {
  const bool all = text == "all";
  for (const std::string& spec : SpecsOf(text)) {
    const Expected<SolverPtr> solver = registry_.Make(spec);
    // Some combinators do not accept some solvers.
    if (!solver && all) continue;
    if (!solver) return fields_.Fail(line, "solvers", solver.error().message);
    // Baselines and local searches are included only if they are named.
    if (all && !FindsWholePose((*solver)->spec())) continue;
    for (const SolverPtr& other : solvers) {
      if (other->spec().name != (*solver)->spec().name) continue;
      return fields_.Fail(line, "solvers", Quoted(spec) + " is listed twice");
    }
    solvers.push_back(*solver);
  }
}

std::vector<SolverPtr> ExperimentParser::ParseSolvers(const YamlNode& node) {
  std::vector<SolverPtr> solvers;
  if (!fields_.IsSequence(node, "solvers")) return solvers;
  if (!kind_->takes_solvers) {
    fields_.Fail(node.line, "solvers",
                 fmt::format("the kind {} takes no solvers; leave them out", kind_->name));
    return solvers;
  }
  if (!instead_.empty()) {
    for (const std::string& spec : instead_) AddSolvers(spec, 0, solvers);
    return solvers;
  }
  for (const YamlNode& item : node.items) AddSolvers(item.text, item.line, solvers);
  return solvers;
}

}  // namespace sextant
