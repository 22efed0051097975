// SPDX-License-Identifier: Apache-2.0
#include "cli/pose_argument.h"

#include <fmt/core.h>

#include <cmath>

#include "cli/pose_file.h"
#include "geometry/coordinate_range.h"
#include "io/text/number_text.h"

namespace sextant::cli {
namespace {

Expected<Rigid3d> PoseFromNumbers(const std::string& option,
                                  const std::vector<std::string>& texts) {
  constexpr std::size_t kNumbers = 7;
  double values[kNumbers] = {};
  if (texts.size() != kNumbers) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("{}: expected a file, or X Y Z QW QX QY QZ; got {} values", option,
                                 texts.size()));
  }
  for (std::size_t i = 0; i < kNumbers; ++i) {
    SEXTANT_ASSIGN_OR_RETURN(const double value, ParseFinite(texts[i], {.file = option}));
    values[i] = value;
  }
  const Eigen::Quaterniond rotation(values[3], values[4], values[5], values[6]);
  if (std::abs(rotation.norm() - 1.0) > 0.01) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{}: expected a quaternion of length 1, got {:.3f}", option, rotation.norm()));
  }
  const Eigen::Vector3d translation(values[0], values[1], values[2]);
  if (translation.cwiseAbs().maxCoeff() > kMaxCoordinate_m) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{}: expected a translation of at most {:g} m", option, kMaxCoordinate_m));
  }
  return Rigid3d{rotation.normalized(), translation};
}

}  // namespace

Expected<Rigid3d> PoseFromArgument(const std::string& option,
                                   const std::vector<std::string>& values) {
  if (values.size() == 1) return ReadPoseFile(values.front());
  return PoseFromNumbers(option, values);
}

}  // namespace sextant::cli
