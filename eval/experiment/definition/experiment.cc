// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/definition/experiment.h"

#include "base/random.h"
#include "eval/experiment/definition/experiment_parser.h"
#include "io/text/text_file.h"

namespace sextant {

Expected<Experiment> ParseExperiment(std::string_view text, const std::string& file,
                                     const std::vector<TrialKind>& kinds,
                                     const SolverRegistry& registry, const std::string& solvers) {
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<SpecNode> specs,
                           solvers.empty() ? std::vector<SpecNode>() : ParseSpecList(solvers));
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  return ExperimentParser(file, kinds, registry, specs).Parse(root);
}

Expected<Experiment> ReadExperiment(const std::filesystem::path& path,
                                    const std::vector<TrialKind>& kinds,
                                    const SolverRegistry& registry, const std::string& solvers) {
  return ReadWith(path, [&](std::string_view text, const std::string& file) {
    return ParseExperiment(text, file, kinds, registry, solvers);
  });
}

std::uint64_t SeedOf(const Experiment& experiment, const Condition& condition,
                     std::uint64_t trial) {
  // The seed depends on the names, so a condition keeps its trials when others are added.
  const std::string place =
      experiment.same_seeds ? experiment.name : experiment.name + "/" + condition.name;
  return DeriveSeed(experiment.seed, place, 0, trial);
}

}  // namespace sextant
