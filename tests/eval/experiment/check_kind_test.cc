// SPDX-License-Identifier: Apache-2.0
// The kind `check`: sextant check on simulated everyday scenes.
#include <gtest/gtest.h>

#include <string>

#include "eval/experiment/definition/experiment.h"
#include "solvers/builtin_solvers.h"

namespace sextant {
namespace {

// The rows of the first trials of an experiment's only condition.
TrialRows RunCheck(const Experiment& experiment, std::uint64_t trials) {
  TrialRows rows(experiment.metrics.size(), experiment.wanted);
  const Condition& condition = experiment.conditions[0];
  for (std::uint64_t trial = 0; trial < trials; ++trial) {
    rows.BeginTrial(trial);
    condition.trials->Run({trial, SeedOf(experiment, condition, trial)}, rows);
  }
  return rows;
}

TEST(CheckKind, StatesOneAnswerForEachTrialAndTheSameAgain) {
  const Expected<Experiment> experiment =
      ParseExperiment("kind: check\ntrials: 2\nparameters: {place: room, pool: 2, pairs: 1}\n",
                      "try.yaml", BuiltinKinds(), BuiltinSolvers());
  ASSERT_TRUE(experiment) << experiment.error().message;
  const TrialRows rows = RunCheck(*experiment, 2);
  ASSERT_EQ(rows.keys().size(), 2U);
  for (std::size_t r = 0; r < 2; ++r) {
    const double* row = rows.values().data() + r * rows.metrics();
    EXPECT_EQ(row[0] + row[1] + row[2], 1.0) << "valid, moved or unknown";
    EXPECT_EQ(row[1], 0.0) << "the given pose is right";
    EXPECT_GT(row[3], 0.02);
    EXPECT_LE(row[3], 1.0);
  }
  const TrialRows again = RunCheck(*experiment, 1);
  EXPECT_EQ(rows.values()[3], again.values()[3]);
}

TEST(CheckKind, RefusesAnUnknownPlaceAndMorePairsThanScenes) {
  for (const char* parameters : {"{place: beach}", "{pool: 2, pairs: 3}", "{lidar_model: vlp61}"}) {
    EXPECT_FALSE(ParseExperiment(std::string("kind: check\ntrials: 1\nparameters: ") + parameters,
                                 "try.yaml", BuiltinKinds(), BuiltinSolvers()))
        << parameters;
  }
}

}  // namespace
}  // namespace sextant
