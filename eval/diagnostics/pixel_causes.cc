// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "eval/diagnostics/causes.h"
#include "solvers/matching/point_order.h"

namespace sextant {
namespace {

using Pairs = std::vector<Pair2d3d>;

// Below this share of the pixels' spread, the pose that fits is that of the data.
constexpr double kMinPixelMisfit = 0.02;
constexpr double kFarBetterPixels = 0.25;
constexpr double kEqualFaults = 1.5;

/// How well a pose explains pairs.
struct PixelFit {
  Rigid3d pose;
  double rmse = 0.0;
  double of_spread = 0.0;  // RMSE over the spread of the pixels.
};

double SpreadOfPixels(const Pairs& pairs) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Pair2d3d& pair : pairs) mean += pair.pixel / static_cast<double>(pairs.size());
  double squares = 0.0;
  for (const Pair2d3d& pair : pairs) squares += (pair.pixel - mean).squaredNorm();
  return std::sqrt(squares / static_cast<double>(pairs.size()));
}

std::optional<PixelFit> FitOf(const Pairs& pairs, const Camera& camera) {
  const auto order = FitGivenOrder(*ModelOf(pairs, camera));
  const double spread = SpreadOfPixels(pairs);
  if (!order || !(spread > 0.0)) return std::nullopt;
  return PixelFit{order->cam_from_lidar, order->rmse, order->rmse / spread};
}

// Those that the camera's model can explain, evenly spread over the list.
Pairs SomeOf(std::span<const Pair2d3d> pairs, const Camera& camera) {
  constexpr std::size_t kMaxPairs = 24;
  const std::size_t count = std::min(pairs.size(), kMaxPairs);
  Pairs some;
  for (std::size_t i = 0; i < count; ++i) {
    const Pair2d3d& pair = pairs[i * pairs.size() / count];
    if (Unproject(camera, pair.pixel)) some.push_back(pair);
  }
  return some;
}

/// A fault of the data, and what undoes it. `undo` is false where it cannot be the fault.
struct Fault {
  std::string text;
  std::string remedy;
  std::function<bool(Pairs&, Camera&)> undo;
};

template <class Change>
auto EachPixel(Change change) {
  return [change](Pairs& pairs, Camera&) {
    for (Pair2d3d& pair : pairs) pair.pixel = change(pair.pixel);
    return true;
  };
}

void AddMirrors(const Camera& camera, std::vector<Fault>& faults) {
  const double right = camera.width_px > 0 ? camera.width_px - 1.0 : 2.0 * camera.cx_px;
  const double bottom = camera.height_px > 0 ? camera.height_px - 1.0 : 2.0 * camera.cy_px;
  using Eigen::Vector2d;
  faults.push_back({"u and v are exchanged", "exchange the two columns",
                    EachPixel([](const Vector2d& p) { return Vector2d(p.y(), p.x()); })});
  faults.push_back(
      {"u is counted from the right border", "replace u by the image's width - 1 - u",
       EachPixel([right](const Vector2d& p) { return Vector2d(right - p.x(), p.y()); })});
  faults.push_back(
      {"v is counted from below", "replace v by the image's height - 1 - v",
       EachPixel([bottom](const Vector2d& p) { return Vector2d(p.x(), bottom - p.y()); })});
  // The pixels do not determine which axis it is: a rotation turns one into the other.
  faults.push_back(
      {"the LiDAR's points are mirrored (an axis has the wrong sign, or two are exchanged)",
       "correct the LiDAR's axes", [](Pairs& pairs, Camera&) {
         for (Pair2d3d& pair : pairs) pair.point_in_lidar.y() *= -1.0;
         return true;
       }});
}

void AddNormalised(std::vector<Fault>& faults) {
  faults.push_back({"the pixels are already normalised (divided by the focal length)",
                    "give pixels, or a camera with fx = fy = 1 and cx = cy = 0 without distortion",
                    [](Pairs& pairs, Camera& camera) {
                      constexpr double kMaxNormalised = 10.0;
                      for (Pair2d3d& pair : pairs) {
                        if (pair.pixel.cwiseAbs().maxCoeff() > kMaxNormalised) return false;
                        const auto pixel = Project(camera, pair.pixel.homogeneous());
                        if (!pixel) return false;
                        pair.pixel = *pixel;
                      }
                      return true;
                    }});
}

void AddSizes(const Camera& camera, std::vector<Fault>& faults) {
  for (const double factor :
       {2.0, 0.5, 4.0, 0.25, 3.0, 1.0 / 3.0, 1.5, 2.0 / 3.0, 4.0 / 3.0, 0.75, 1.25, 0.8}) {
    const std::string size = camera.width_px > 0
                                 ? fmt::format(" ({:.0f} x {:.0f} px)", camera.width_px / factor,
                                               camera.height_px / factor)
                                 : "";
    faults.push_back(
        {fmt::format("the pixels are of an image {:.3g} times as large as the camera's{}",
                     1.0 / factor, size),
         fmt::format("multiply the pixels by {:.3g}, or give the intrinsics of that size", factor),
         EachPixel([factor](const Eigen::Vector2d& p) {
           return Eigen::Vector2d(factor * (p.array() + 0.5) - 0.5);
         })});
  }
}

double MisfitWithFocal(const Pairs& pairs, Camera camera, double factor) {
  camera.fx_px *= factor;
  camera.fy_px *= factor;
  const std::optional<PixelFit> fit = FitOf(pairs, camera);
  return fit ? fit->of_spread : std::numeric_limits<double>::infinity();
}

// The best factor of the focal length, by a scan in octaves and a search by thirds.
void AddFocal(const Pairs& pairs, const Camera& camera, std::vector<Fault>& faults) {
  constexpr double kMaxOctaves = 4.0;
  constexpr double kStep = 0.5;
  constexpr int kThirds = 10;
  double best = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (double octaves = -kMaxOctaves; octaves <= kMaxOctaves; octaves += kStep) {
    const double misfit = MisfitWithFocal(pairs, camera, std::exp2(octaves));
    if (misfit >= least) continue;
    least = misfit;
    best = octaves;
  }
  double low = best - kStep;
  double high = best + kStep;
  for (int i = 0; i < kThirds; ++i) {
    const double third = (high - low) / 3.0;
    const bool is_left = MisfitWithFocal(pairs, camera, std::exp2(low + third)) <
                         MisfitWithFocal(pairs, camera, std::exp2(high - third));
    (is_left ? high : low) += is_left ? -third : third;
  }
  const double factor = std::exp2(0.5 * (low + high));
  faults.push_back({fmt::format("the focal length is about {:.4g} px instead of {:.4g} px",
                                factor * camera.fx_px, camera.fx_px),
                    "check the camera matrix and the image that it belongs to",
                    [factor](Pairs&, Camera& changed) {
                      changed.fx_px *= factor;
                      changed.fy_px *= factor;
                      return true;
                    }});
}

struct Explanation {
  const Fault* fault;
  PixelFit fit;
};

// The faults that explain the data about as well as the best one does.
std::vector<Explanation> ExplanationsOf(const Pairs& pairs, const Camera& camera,
                                        const std::vector<Fault>& faults, double most) {
  std::vector<Explanation> found;
  for (const Fault& fault : faults) {
    Pairs changed = pairs;
    Camera changed_camera = camera;
    if (!fault.undo(changed, changed_camera)) continue;
    const std::optional<PixelFit> fit = FitOf(changed, changed_camera);
    if (!fit || fit->of_spread > most) continue;
    found.push_back({&fault, *fit});
  }
  std::ranges::stable_sort(found, {}, [](const Explanation& e) { return e.fit.of_spread; });
  const double equal = found.empty() ? 0.0 : kEqualFaults * found.front().fit.of_spread + 1e-6;
  std::erase_if(found, [&](const Explanation& e) { return e.fit.of_spread > equal; });
  return found;
}

std::string SentenceOf(const std::vector<Explanation>& found, const PixelFit& given) {
  constexpr std::size_t kMaxListed = 3;
  std::string text = "pixels: it seems that ";
  for (std::size_t i = 0; i < std::min(found.size(), kMaxListed); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : ", or that ", found[i].fault->text);
  }
  const PixelFit& fit = found.front().fit;
  text += fmt::format(
      "; RMSE {:.3g} px, {:.1f} % of the pixels' spread, becomes {:.3g} px, {:.2g} %, without; {}",
      given.rmse, 100.0 * given.of_spread, fit.rmse, 100.0 * fit.of_spread,
      found.front().fault->remedy);
  return text + (found.size() > 1 ? ", or the other change" : "");
}

std::optional<std::string> FindFault(const Pairs& pairs, const Camera& camera,
                                     const PixelFit& given) {
  std::vector<Fault> faults;
  AddMirrors(camera, faults);
  AddNormalised(faults);
  AddSizes(camera, faults);
  const double most = std::min(kFarBetterPixels * given.of_spread, kMinPixelMisfit);
  std::vector<Explanation> found = ExplanationsOf(pairs, camera, faults, most);
  if (found.empty()) {
    // A free focal length explains part of nearly everything: it comes last.
    faults.clear();
    AddFocal(pairs, camera, faults);
    found = ExplanationsOf(pairs, camera, faults, most);
  }
  if (found.empty()) return std::nullopt;
  return SentenceOf(found, given);
}

// A board at such a distance could not be seen.
std::optional<std::string> FindMillimetres(const Pairs& pairs, const Rigid3d& pose) {
  constexpr double kMinSpread_m = 100.0;
  constexpr double kMinDistance_m = 500.0;
  Eigen::AlignedBox3d box;
  for (const Pair2d3d& pair : pairs) box.extend(pair.point_in_lidar);
  const double spread = box.sizes().norm();
  const double distance = (pose * box.center()).norm();
  if (spread < kMinSpread_m || distance < kMinDistance_m) return std::nullopt;
  const Eigen::Vector3d t = 1e-3 * pose.translation;
  return fmt::format(
      "units: the LiDAR's points spread over {:.4g} m and are {:.4g} m from the camera; if they "
      "are in millimetres, multiply them by 0.001: the translation is then {:.4f} {:.4f} {:.4f} m",
      spread, distance, t.x(), t.y(), t.z());
}

}  // namespace

std::vector<std::string> CausesInPixels(const CalibrationProblem& problem) {
  constexpr std::size_t kMinForUnits = 4;
  constexpr std::size_t kMinForFaults = 6;
  std::vector<std::string> causes;
  if (!problem.camera || problem.pairs_2d3d.size() < kMinForUnits ||
      !ValidateCamera(*problem.camera)) {
    return causes;
  }
  const Pairs pairs = SomeOf(problem.pairs_2d3d, *problem.camera);
  const std::optional<PixelFit> given = FitOf(pairs, *problem.camera);
  const bool fits = given && given->of_spread < kMinPixelMisfit;
  if (!fits && pairs.size() >= kMinForFaults) {
    const PixelFit as_given = given.value_or(PixelFit{{}, SpreadOfPixels(pairs), 1.0});
    if (auto fault = FindFault(pairs, *problem.camera, as_given)) {
      causes.push_back(*std::move(fault));
    }
  }
  if (!fits) return causes;
  if (auto units = FindMillimetres(pairs, given->pose)) causes.push_back(*std::move(units));
  return causes;
}

}  // namespace sextant
