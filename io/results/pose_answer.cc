// SPDX-License-Identifier: Apache-2.0
#include "io/results/pose_answer.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "base/text/printable.h"
#include "geometry/coordinate_range.h"
#include "io/blocks/rigid_matrix.h"
#include "io/text/json_depth.h"

namespace sextant {
namespace {

using AnswerJson = nlohmann::json;

constexpr std::size_t kMaxQuoted = 200;

tl::unexpected<Error> BadAnswer(const std::string& what) {
  return MakeError(ErrorCode::kParse, "the answer is no pose: " + what);
}

template <std::size_t kSize>
std::optional<std::array<double, kSize>> NumbersAt(const AnswerJson& map, const char* key) {
  const auto found = map.find(key);
  if (found == map.end() || !found->is_array() || found->size() != kSize) return std::nullopt;
  std::array<double, kSize> numbers{};
  for (std::size_t i = 0; i < kSize; ++i) {
    if (!(*found)[i].is_number()) return std::nullopt;
    numbers[i] = (*found)[i].get<double>();
  }
  return numbers;
}

template <int kSize>
std::optional<Eigen::Matrix<double, kSize, kSize>> MatrixAt(const AnswerJson& map,
                                                            const char* key) {
  const auto found = map.find(key);
  if (found == map.end() || !found->is_array() || found->size() != kSize) return std::nullopt;
  Eigen::Matrix<double, kSize, kSize> matrix;
  for (int row = 0; row < kSize; ++row) {
    const AnswerJson& cells = (*found)[static_cast<std::size_t>(row)];
    if (!cells.is_array() || cells.size() != kSize) return std::nullopt;
    for (int column = 0; column < kSize; ++column) {
      const AnswerJson& cell = cells[static_cast<std::size_t>(column)];
      if (!cell.is_number()) return std::nullopt;
      matrix(row, column) = cell.get<double>();
    }
  }
  return matrix;
}

Expected<Rigid3d> PoseAt(const AnswerJson& map) {
  constexpr double kMaxQuaternionError = 1e-3;
  if (map.contains("matrix")) {
    const auto matrix = MatrixAt<4>(map, "matrix");
    const auto pose = matrix ? RigidFromMatrix(*matrix) : std::nullopt;
    if (!pose) return BadAnswer("'matrix' is not 4 rows of 4 of a rotation and a translation");
    return *pose;
  }
  const auto t = NumbersAt<3>(map, "translation_m");
  const auto q = NumbersAt<4>(map, "quaternion_wxyz");
  if (!t || !q) return BadAnswer("expected 'translation_m' and 'quaternion_wxyz', or 'matrix'");
  const Eigen::Quaterniond rotation((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
  if (!(std::abs(rotation.norm() - 1.0) < kMaxQuaternionError)) {
    return BadAnswer("'quaternion_wxyz' does not have length 1");
  }
  const Eigen::Vector3d translation((*t)[0], (*t)[1], (*t)[2]);
  if (!(translation.cwiseAbs().maxCoeff() <= kMaxCoordinate_m)) {
    return BadAnswer(fmt::format("'translation_m' is beyond {:g} m", kMaxCoordinate_m));
  }
  return Rigid3d{rotation.normalized(), translation};
}

Expected<std::vector<int>> InliersAt(const AnswerJson& map, int pairs) {
  std::vector<int> inliers;
  if (!map.contains("inliers")) {
    inliers.resize(static_cast<std::size_t>(pairs));
    std::iota(inliers.begin(), inliers.end(), 0);
    return inliers;
  }
  for (const AnswerJson& number : map.at("inliers")) {
    if (!number.is_number_integer() || number < 0 || number >= pairs) {
      return BadAnswer(fmt::format("'inliers' are not numbers from 0 to {}", pairs - 1));
    }
    inliers.push_back(number.get<int>());
  }
  std::sort(inliers.begin(), inliers.end());
  inliers.erase(std::unique(inliers.begin(), inliers.end()), inliers.end());
  return inliers;
}

Expected<Estimate> EstimateOf(const AnswerJson& json, int pairs) {
  if (!json.is_object()) return BadAnswer("expected a JSON object");
  if (json.contains("error")) {
    const AnswerJson& error = json.at("error");
    const std::string text = error.is_string() ? error.get<std::string>() : std::string();
    return MakeError(ErrorCode::kNoConsensus, text.empty()
                                                  ? "the program reports an error without a text"
                                                  : Printable(text, kMaxQuoted));
  }
  Estimate estimate;
  const bool nested = json.contains("cam_from_lidar") && json.at("cam_from_lidar").is_object();
  SEXTANT_ASSIGN_OR_RETURN(estimate.cam_from_lidar,
                           PoseAt(nested ? json.at("cam_from_lidar") : json));
  if (json.contains("covariance") && !json.at("covariance").is_null()) {
    estimate.covariance = MatrixAt<6>(json, "covariance");
    const bool is_valid = estimate.covariance && estimate.covariance->allFinite() &&
                          estimate.covariance->diagonal().minCoeff() >= 0.0;
    if (!is_valid) return BadAnswer("'covariance' is not 6 rows of 6 with variances >= 0");
  }
  SEXTANT_ASSIGN_OR_RETURN(estimate.inliers, InliersAt(json, pairs));
  if (json.contains("iterations") && json.at("iterations").is_number_unsigned()) {
    constexpr std::uint64_t kMaxIterations = 1'000'000'000;
    estimate.iterations =
        static_cast<int>(std::min(kMaxIterations, json.at("iterations").get<std::uint64_t>()));
  }
  if (json.contains("warnings") && json.at("warnings").is_array()) {
    for (const AnswerJson& warning : json.at("warnings")) {
      if (!warning.is_string()) return BadAnswer("'warnings' are not texts");
      estimate.warnings.push_back(Printable(warning.get<std::string>(), kMaxQuoted));
    }
  }
  return estimate;
}

}  // namespace

Expected<Estimate> ParsePoseAnswer(std::string_view text, int pairs) {
  if (IsJsonTooDeep(text)) return BadAnswer("it is nested too deep");
  const AnswerJson json = AnswerJson::parse(text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) {
    return BadAnswer(fmt::format("expected JSON, got '{}'", Printable(text, 60)));
  }
  return EstimateOf(json, pairs);
}

}  // namespace sextant
