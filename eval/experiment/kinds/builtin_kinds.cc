// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/definition/trials.h"

// One line per kind, in the order of the catalogue; X(Name) refers to `TrialKind NameKind()` in the
// kind's own file.
#define SEXTANT_KINDS(X) \
  X(RandomScene)         \
  X(BoardViews)          \
  X(Scene)               \
  X(SceneAverage)        \
  X(AverageLog)          \
  X(BoardScan)           \
  X(BoardImage)          \
  X(Fusion)              \
  X(Session)             \
  X(RealPairs)           \
  X(RealViews)           \
  X(Check)

namespace sextant {

#define SEXTANT_DECLARE(name) TrialKind name##Kind();
SEXTANT_KINDS(SEXTANT_DECLARE)
#undef SEXTANT_DECLARE

std::vector<TrialKind> BuiltinKinds() {
  std::vector<TrialKind> kinds;
#define SEXTANT_ADD(name) kinds.push_back(name##Kind());
  SEXTANT_KINDS(SEXTANT_ADD)
#undef SEXTANT_ADD
  return kinds;
}

}  // namespace sextant
