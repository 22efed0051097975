// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "solvers/core/rig_problem.h"

namespace sextant {

/// What one sensor measured of one feature of a board, as a row of a table states it.
struct FeatureRow {
  int line = 0;          ///< In the file, for messages.
  std::string moment{};  ///< Empty: the time states it.
  std::string sensor{};
  std::optional<int> board{};                   ///< None: the only one.
  std::optional<int> corner{};                  ///< Index into the board's points.
  std::optional<Eigen::Vector2d> in_board_m{};  ///< In place of `corner`.
  std::optional<double> time_s{};               ///< The sensor's stamp.
  std::optional<Eigen::Vector2d> pixel{};
  std::optional<double> sigma_px{};
  std::optional<Eigen::Vector3d> position_m{};  ///< Where that corner is, in the sensor frame.
  std::optional<double> sigma_m{};              ///< For each axis of `position_m`.
  std::optional<MeasuredPlane> plane{};
  std::optional<MeasuredLine> side{};
};

/// Reads a table (CSV) of features: the first line names the columns, in any order; separators and
/// decimal commas as in pairs_csv.h. A value may be empty where a row does not have it.
/// - `moment` or `time_s`, `sensor`, and `board` unless there is only one;
/// - `corner` (or `board_x`, `board_y`) with `u`, `v` (px) or `x`, `y`, `z` (m) or both;
/// - `nx`, `ny`, `nz`, `distance`: a plane with normal . point = distance, of unit normal; or `a`,
///   `b`, `c`, `d`: the plane a x + b y + c z + d = 0;
/// - `side` with `x`, `y`, `z`, a point on the line, and its direction `dx`, `dy`, `dz` or a second
///   point `x2`, `y2`, `z2`;
/// - `sigma_px`, `sigma_m`, `sigma_deg` (of a normal).
/// Errors: kIo; kParse, for an unknown column with a suggestion; kNonFinite; with line and field.
/// Time and memory are linear in the file's size.
Expected<std::vector<FeatureRow>> ReadFeatureTable(const std::filesystem::path& path);
Expected<std::vector<FeatureRow>> ParseFeatureTable(std::string_view text, const std::string& file);

}  // namespace sextant
