// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "solvers/core/solver.h"

namespace sextant {

/// Reads the answer of another program's solver, a JSON object:
/// - the pose: "translation_m" (3 numbers) and "quaternion_wxyz" (4), or "matrix" (4 rows of 4), in
///   the object itself or in its "cam_from_lidar";
/// - optionally "covariance", 6 rows of 6, of (dphi [rad], dt [m]); "inliers", numbers of pairs
/// from
///   0; "iterations"; "warnings", a list of texts;
/// - or, instead of all these, "error": the text of why there is none.
/// Other keys are not used. `pairs` is the number of pairs that inliers may name; without the key
/// they are all of them.
/// Errors: kNoConsensus for "error"; kParse, with the key. Time and memory are linear in the text.
Expected<Estimate> ParsePoseAnswer(std::string_view text, int pairs);

}  // namespace sextant
