// SPDX-License-Identifier: Apache-2.0
#include "io/original/average_log.h"

#include <fmt/core.h>

#include "io/blocks/rigid_matrix.h"
#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

// Rounding to eight decimals leaves less than this in R R^T - I.
constexpr double kRotationTolerance = 1e-4;

bool ReadLine(LineReader& in, std::size_t fields, const std::string& what) {
  return in.Require(what) && in.HasFields(fields, what);
}

RunningAverageRow ReadIteration(LineReader& in, int iteration) {
  RunningAverageRow row;
  row.iteration = iteration;
  const auto of_this = [iteration](const char* what) {
    return fmt::format("{} of iteration {}", what, iteration);
  };
  if (ReadLine(in, 1, of_this("the number"))) in.Integer(0, iteration, iteration, "iteration");
  for (int k = 0; k < 3; ++k) {
    if (ReadLine(in, 1, of_this("a line of the translation (m)"))) {
      row.mean_translation_m[k] = in.Real(0);
    }
  }
  for (int i = 0; i < 3; ++i) {
    if (!ReadLine(in, 3, of_this("a row of the rotation"))) continue;
    for (int j = 0; j < 3; ++j) row.rotation(i, j) = in.Real(static_cast<std::size_t>(j));
  }
  if (in.ok() && !IsRotation(row.rotation, kRotationTolerance)) {
    in.Fail(ErrorCode::kParse, "expected three rows of a rotation matrix up to here");
  }
  if (ReadLine(in, 1, of_this("the RMSE (m)"))) row.rmse_m = in.Real(0);
  if (row.rmse_m < 0.0) in.Fail(ErrorCode::kParse, "expected an RMSE of zero or more");
  return row;
}

}  // namespace

Expected<std::vector<RunningAverageRow>> ReadAverageLog(const std::filesystem::path& path) {
  return ReadWith(path, ParseAverageLog);
}

Expected<std::vector<RunningAverageRow>> ParseAverageLog(std::string_view text,
                                                         const std::string& file) {
  std::vector<RunningAverageRow> rows;
  LineReader in(file, text);
  do {
    rows.push_back(ReadIteration(in, static_cast<int>(rows.size()) + 1));
  } while (in.ok() && !in.AtEnd());
  if (!in.ok()) return in.TakeError();
  return rows;
}

}  // namespace sextant
