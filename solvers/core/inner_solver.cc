// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/inner_solver.h"

#include <fmt/core.h>

namespace sextant {

Expected<void> CheckKeepsCamera(const Solver& inner, const std::string& outer) {
  if (!inner.spec().estimates_camera) return {};
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("{}: '{}' estimates intrinsics, which only the outermost solver "
                               "may; put {} inside",
                               outer, inner.spec().name, outer));
}

Expected<PairKind> KindOfPairs(const Solver& inner, const std::string& outer) {
  SEXTANT_RETURN_IF_ERROR(CheckKeepsCamera(inner, outer));
  const DataNeeds& needs = inner.spec().needs;
  if (needs.board_views > 0) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{}: '{}' works on raw views of boards, expected a solver of pairs; put {} "
                    "inside",
                    outer, inner.spec().name, outer));
  }
  if (needs.points_per_set > 0 || (needs.pairs_3d3d == 0 && needs.pairs_2d3d == 0)) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{}: '{}' works on point sets, expected a solver of pairs such as kabsch",
                    outer, inner.spec().name));
  }
  if (needs.pairs_3d3d > 0 && needs.pairs_2d3d > 0) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format(
            "{}: '{}' needs both kinds of pairs, expected a solver of one kind; put {} inside",
            outer, inner.spec().name, outer));
  }
  return needs.pairs_3d3d > 0 ? PairKind::k3d3d : PairKind::k2d3d;
}

}  // namespace sextant
