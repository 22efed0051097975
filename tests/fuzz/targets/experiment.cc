// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/definition/experiment.h"

#include "eval/experiment/run/configuration.h"
#include "io/problems/data_manifest.h"
#include "solvers/all/all_solvers.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {
namespace {

// Trials that are never run; those of the library may take minutes to make.
class NoTrials final : public Trials {
 public:
  explicit NoTrials(const std::vector<SolverPtr>& solvers) {
    for (const SolverPtr& solver : solvers) subjects_.push_back(solver->spec().name);
  }
  const std::vector<std::string>& subjects() const override { return subjects_; }
  void Run(const TrialId&, TrialRows&) const override {}

 private:
  std::vector<std::string> subjects_;
};

std::vector<TrialKind> KindsThatRunNothing() {
  std::vector<TrialKind> kinds = BuiltinKinds();
  for (TrialKind& kind : kinds) {
    kind.make = [](const KindArguments& arguments) -> Expected<TrialsPtr> {
      return std::make_shared<NoTrials>(arguments.solvers);
    };
  }
  return kinds;
}

}  // namespace

// An experiment, or the data set that one of real data names.
SEXTANT_FUZZ_TARGET(experiment, bytes) {
  CheckOutcome(ParseManifest(bytes, "f"));
  static const std::vector<TrialKind> kinds = KindsThatRunNothing();
  static const SolverRegistry registry = AllSolvers();
  const Expected<Experiment> experiment = ParseExperiment(bytes, "f", kinds, registry);
  CheckOutcome(experiment);
  if (!experiment) return;
  const std::string configuration = ConfigurationOf(*experiment);
  if (CountMetrics(configuration) != experiment->wanted.count()) Fault("metrics are lost");
  if (CountBlocks(configuration) < experiment->conditions.size()) Fault("blocks are lost");
}

}  // namespace sextant::test
