// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/pair_scorer.h"

#include <algorithm>

#include "solvers/robust/column_scorer.h"
#include "solvers/robust/term_scorer.h"

namespace sextant {

std::unique_ptr<PairScorer> MakePairScorer(const CalibrationProblem& problem, PairKind kind) {
  if (kind == PairKind::k3d3d && AreIsotropic(problem.pairs_3d3d)) {
    return std::make_unique<ColumnScorer>(problem.pairs_3d3d);
  }
  return std::make_unique<TermScorer>(MakeTerms(problem, kind));
}

bool AreIsotropic(std::span<const Pair3d3d> pairs) {
  return std::none_of(pairs.begin(), pairs.end(),
                      [](const Pair3d3d& pair) { return pair.covariance_in_cam.has_value(); });
}

}  // namespace sextant
