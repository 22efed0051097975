// SPDX-License-Identifier: Apache-2.0
#include "solvers/builtin_solvers.h"

#include "solvers/core/registry.h"

// One line a solver, in the order of the catalogue; X(Name) is `SolverEntry NameEntry()` in the
// solver's own file. An explicit table: the linker drops self-registering objects.
#define SEXTANT_SOLVERS(X) \
  X(Kabsch)                \
  X(EigenUmeyama)          \
  X(MeanOffset)            \
  X(P3p)                   \
  X(Epnp)                  \
  X(Sqpnp)                 \
  X(Ippe)                  \
  X(Dlt)                   \
  X(Icp)                   \
  X(Ransac)                \
  X(Gnc)                   \
  X(Clique)                \
  X(Robust)                \
  X(DropWorst)             \
  X(Refine)                \
  X(Joint)                 \
  X(Average)

namespace sextant {

#define SEXTANT_DECLARE(name) SolverEntry name##Entry();
SEXTANT_SOLVERS(SEXTANT_DECLARE)
#undef SEXTANT_DECLARE

SolverRegistry BuiltinSolvers() {
  SolverRegistry registry;
#define SEXTANT_ADD(name) registry.Add(name##Entry());
  SEXTANT_SOLVERS(SEXTANT_ADD)
#undef SEXTANT_ADD
  return registry;
}

}  // namespace sextant
