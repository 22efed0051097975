// SPDX-License-Identifier: Apache-2.0
#include "io/original/original_config.h"

#include <fmt/core.h>

#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

constexpr std::size_t kPlain = 23;
constexpr std::size_t kRotation = 27;
constexpr std::size_t kRotationType = 28;
constexpr std::size_t kRotationTranslation = 30;
constexpr std::size_t kAll = 31;

// A stream of numbers; as in the original package, line breaks do not matter.
class NumberStream {
 public:
  NumberStream(const std::string& file, std::string_view text) : in_(file, text) {}

  double Real(std::string_view name) { return Advance(name) ? in_.Real(next_++, name) : 0.0; }
  int Integer(std::string_view name, int low, int high) {
    return Advance(name) ? static_cast<int>(in_.Integer(next_++, low, high, name)) : 0;
  }
  Eigen::Vector3d Vector(const std::array<const char*, 3>& names) {
    Eigen::Vector3d v;
    for (int k = 0; k < 3; ++k) v[k] = Real(names[static_cast<std::size_t>(k)]);
    return v;
  }
  std::array<double, 2> Range(const char* low_name, const char* high_name) {
    const double low = Real(low_name);
    const double high = Real(high_name);
    if (!(low <= high)) {
      in_.Fail(ErrorCode::kParse,
               fmt::format("expected {} <= {}, got {} and {}", low_name, high_name, low, high));
    }
    return {low, high};
  }
  LineReader& lines() { return in_; }

 private:
  bool Advance(std::string_view name) {
    if (next_ < in_.field_count()) return in_.ok();
    next_ = 0;
    return in_.Require(name);
  }

  LineReader in_;
  std::size_t next_ = 0;
};

std::size_t CountNumbers(std::string_view text) {
  LineReader in({}, text);
  std::size_t count = 0;
  while (in.Next()) count += in.field_count();
  return count;
}

}  // namespace

Rigid3d OriginalConfig::InitialPose() const {
  const Eigen::Vector3d angles = initial_rotation_rad.value_or(Eigen::Vector3d::Zero());
  return {FromEulerZyx({.yaw = angles.z(), .pitch = angles.y(), .roll = angles.x()}),
          initial_translation_m.value_or(Eigen::Vector3d::Zero())};
}

Expected<OriginalConfig> ReadOriginalConfig(const std::filesystem::path& path) {
  return ReadWith(path, ParseOriginalConfig);
}

Expected<OriginalConfig> ParseOriginalConfig(std::string_view text, const std::string& file) {
  constexpr int kMax = 1'000'000;
  const std::size_t count = CountNumbers(text);
  NumberStream in(file, text);
  OriginalConfig config;
  config.width_px = in.Integer("width", 1, kMax);
  config.height_px = in.Integer("height", 1, kMax);
  config.x_range_m = in.Range("x-", "x+");
  config.y_range_m = in.Range("y-", "y+");
  config.z_range_m = in.Range("z-", "z+");
  config.intensity_threshold = in.Real("intensity threshold");
  config.markers = in.Integer("number of markers", 1, kMax);
  config.use_camera_info = in.Integer("use camera_info", 0, 1) == 1;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      config.projection(i, j) = in.Real(fmt::format("P({},{})", i + 1, j + 1));
    }
  }
  if (count > kPlain) {
    config.max_iterations = in.Integer("MAX_ITERS", 1, kMax);
    config.initial_rotation_rad =
        in.Vector({"initial rotation x", "initial rotation y", "initial rotation z"});
  }
  if (count >= kRotationTranslation) {
    config.initial_translation_m =
        in.Vector({"initial translation x", "initial translation y", "initial translation z"});
  }
  if (count == kRotationType || count >= kAll) config.lidar_type = in.Integer("lidar_type", 0, 1);
  if (count != kPlain && count != kRotation && count != kRotationType &&
      count != kRotationTranslation && count != kAll) {
    in.lines().Fail(
        ErrorCode::kParse,
        fmt::format("expected 23, 27, 28, 30 or 31 numbers in the file, got {}", count));
  }
  if (!in.lines().ok()) return in.lines().TakeError();
  return config;
}

}  // namespace sextant
