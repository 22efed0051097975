// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/camera.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// A sensor of a calibrated rig.
struct RigResultSensor {
  std::string name{};
  std::optional<Camera> camera{};             ///< None: a LiDAR.
  std::optional<Rigid3d> root_from_sensor{};  ///< None: not connected with the root.
  std::optional<Matrix6d> covariance{};       ///< That of root_from_sensor; none for the root.
  int views = 0;                              ///< Boards that it sees together with another sensor.
  int used = 0;                               ///< Those in use.
  std::optional<Rigid3d> true_root_from_sensor{};
};

/// Two connected sensors; `a` comes first in the list of sensors.
struct RigResultPair {
  std::string a{};
  std::string b{};
  Rigid3d a_from_b{};
  std::optional<Matrix6d> covariance{};  ///< Order: dphi [rad], dt [m]; see Perturb.
  int views = 0;                         ///< Boards that both see.
  /// The pair calibrated alone, where its own views determine it.
  std::optional<Rigid3d> alone_a_from_b{};
  std::optional<Matrix6d> alone_covariance{};
  /// The distance of both answers in sigmas of the pair alone, root of the mean square over the six
  /// axes: about 1 or less where the sensors agree.
  std::optional<double> alone_sigmas{};
};

/// A board in one moment, by the sensors that saw it.
struct RigResultView {
  std::string moment{};
  int board = 0;
  struct Seen {
    std::string sensor{};
    bool used = false;
    double rms = 0.0;  ///< The whitened residuals at their stated noise.
  };
  std::vector<Seen> seen{};
};

/// A number that was estimated with the poses: a constant range error and the like, or the noise of
/// a kind of observations over the stated one.
struct RigResultNumber {
  std::string sensor{};
  std::string name{};
  double value = 0.0;
  std::optional<double> sigma{};
};

/// The poses of all sensors of a rig.
struct RigResult {
  std::string version{};  ///< Version of sextant that wrote it.
  std::string root{};
  std::vector<RigResultSensor> sensors{};
  std::vector<RigResultPair> pairs{};
  std::vector<RigResultView> views{};
  std::vector<RigResultNumber> numbers{};
  std::vector<std::string> unconnected{};  ///< What would connect each sensor without a pose.
  std::vector<std::string> warnings{};
  std::vector<std::string> refutations{};  ///< Why it is NOT USABLE; usually none.

  const RigResultSensor* Find(std::string_view name) const;
  /// Errors: kUnknownName, with the names; kMissingData where a sensor is not connected.
  Expected<Rigid3d> Between(std::string_view a, std::string_view b) const;
};

/// rig.json; docs/formats.md documents its keys.
std::string FormatRigResult(const RigResult& result);

/// Reads all of it. Errors: kParse and kNonFinite with file, line and key. Time is linear in the
/// file's size; memory is that of ParseYaml (io/text/yaml_node.h).
Expected<RigResult> ParseRigResult(std::string_view text, const std::string& file);

/// Whether a text is that of a rig's result.
bool IsRigResult(std::string_view text);

}  // namespace sextant
