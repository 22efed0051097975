// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "base/error.h"
#include "solvers/core/solver.h"
#include "solvers/kernels/pair_terms.h"

namespace sextant {

/// The kind of pairs that `inner` needs. Error: kInvalidOption where it needs none (point sets) or
/// both, or estimates the camera; `outer` is the name of the wrapping solver for the message.
Expected<PairKind> KindOfPairs(const Solver& inner, const std::string& outer);

/// Error: kInvalidOption where `inner` estimates the camera, which `outer` would ignore.
Expected<void> CheckKeepsCamera(const Solver& inner, const std::string& outer);

}  // namespace sextant
