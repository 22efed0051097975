// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/experiment/definition/parameter_set.h"
#include "eval/experiment/definition/trials.h"
#include "geometry/calibration_problem.h"
#include "io/problems/data_manifest.h"

namespace sextant {

/// How a trial draws from real data, which takes the place of simulated noise.
enum class Resampling {
  kBootstrap,  ///< As many groups as there are, with replacement; those not drawn are held out.
  kHalves,     ///< A random half; the other half is held out, and solved too.
  kHeldOut,    ///< All but a random share.
};

/// What is drawn as one: errors within a group may be correlated.
enum class ResampleBy { kViews, kBoards, kPairs };

struct RealSettings {
  std::string manifest{};
  Resampling resampling = Resampling::kBootstrap;
  ResampleBy by = ResampleBy::kBoards;
  double held_out = 0.2;
  double success_deg = 1.0;
  double success_mm = 50.0;
};

/// The parameters of kinds of real data.
const ParameterSet<RealSettings>& RealParameters();

/// What is measured of each solver in each trial.
const std::vector<Metric>& RealMetrics();

/// The row of a solver without an answer, which is not near the reference either.
void MeasureNoAnswer(bool has_reference, MetricValues values);

/// Trials on one problem: every solver gets the drawn groups, and is measured on those held out, by
/// its distance to the reference, and, with halves, by that to its answer to the other half.
/// A solver that cannot use the data answers nothing. Error: kInvalidInput for fewer than three
/// groups.
Expected<TrialsPtr> MakeRealTrials(CalibrationProblem problem,
                                   const std::optional<ReferencePose>& reference,
                                   const RealSettings& settings, std::vector<SolverPtr> solvers,
                                   const std::string& condition);

/// Those solvers that can use the data, so that one list serves different data sets. Error:
/// kMissingData if none can.
Expected<std::vector<SolverPtr>> SolversFor(const CalibrationProblem& problem,
                                            std::vector<SolverPtr> solvers);

}  // namespace sextant
