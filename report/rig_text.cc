// SPDX-License-Identifier: Apache-2.0
#include "report/rig_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "eval/statistics/text_table.h"
#include "geometry/symmetric.h"
#include "report/wrapped_text.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxViewRows = 40;

std::string Millimetres(const Eigen::Vector3d& metres) {
  return fmt::format("{:.1f} {:.1f} {:.1f}", 1e3 * metres.x(), 1e3 * metres.y(), 1e3 * metres.z());
}

std::string YawPitchRoll(const Eigen::Quaterniond& rotation) {
  const EulerZyx euler = ToEulerZyx(rotation);
  return fmt::format("{:.2f} {:.2f} {:.2f}", kDegPerRad * euler.yaw, kDegPerRad * euler.pitch,
                     kDegPerRad * euler.roll);
}

// One standard deviation of the least certain direction, which no choice of axes changes.
std::string Uncertainty(const std::optional<Matrix6d>& covariance) {
  if (!covariance) return "";
  const auto largest = [](const Eigen::Matrix3d& part) {
    return std::sqrt(EigenOf<3>(part).values[2]);
  };
  return fmt::format("{:.2f} mm {:.3f} deg", 1e3 * largest(covariance->bottomRightCorner<3, 3>()),
                     kDegPerRad * largest(covariance->topLeftCorner<3, 3>()));
}

std::string Distance(const Rigid3d& a, const Rigid3d& b) {
  const PoseDistance off = DistanceBetween(a, b);
  return fmt::format("{:.2f} mm {:.3f} deg", 1e3 * off.translation_m,
                     kDegPerRad * off.rotation_rad);
}

std::string SensorTable(const RigResult& result) {
  const bool has_truth = std::ranges::any_of(result.sensors, [](const RigResultSensor& sensor) {
    return sensor.true_root_from_sensor.has_value();
  });
  std::vector<std::string> header = {
      "sensor", "kind", "boards used", "position [mm]", "yaw pitch roll [deg]", "1 sigma"};
  if (has_truth) header.emplace_back("error");
  TextTable table(header);
  for (const RigResultSensor& sensor : result.sensors) {
    std::vector<std::string> row = {sensor.name, sensor.camera ? "camera" : "3D",
                                    fmt::format("{} of {}", sensor.used, sensor.views)};
    if (!sensor.root_from_sensor) {
      row.insert(row.end(), {"not connected", "", ""});
    } else {
      row.insert(row.end(), {Millimetres(sensor.root_from_sensor->translation),
                             YawPitchRoll(sensor.root_from_sensor->rotation),
                             sensor.name == result.root ? "root" : Uncertainty(sensor.covariance)});
    }
    if (has_truth) {
      row.push_back(sensor.root_from_sensor && sensor.true_root_from_sensor
                        ? Distance(*sensor.root_from_sensor, *sensor.true_root_from_sensor)
                        : "");
    }
    table.AddRow(std::move(row));
  }
  return table.Plain(kTextWidth);
}

std::string PairTable(const RigResult& result) {
  TextTable table({"a_from_b", "boards", "position [mm]", "1 sigma", "1 sigma alone",
                   "alone differs by", "sigmas"});
  for (const RigResultPair& pair : result.pairs) {
    const bool alone = pair.alone_a_from_b.has_value();
    table.AddRow({pair.a + "_from_" + pair.b, std::to_string(pair.views),
                  Millimetres(pair.a_from_b.translation), Uncertainty(pair.covariance),
                  Uncertainty(pair.alone_covariance),
                  alone ? Distance(*pair.alone_a_from_b, pair.a_from_b) : "",
                  pair.alone_sigmas ? Fixed(*pair.alone_sigmas, 1) : ""});
  }
  return table.Plain(kTextWidth);
}

// Blank: not seen.
std::string ViewTable(const RigResult& result) {
  std::vector<std::string> header = {"moment", "board"};
  for (const RigResultSensor& sensor : result.sensors) header.push_back(sensor.name);
  TextTable table(header);
  for (std::size_t i = 0; i < std::min(result.views.size(), kMaxViewRows); ++i) {
    const RigResultView& view = result.views[i];
    std::vector<std::string> row = {view.moment, std::to_string(view.board)};
    for (const RigResultSensor& sensor : result.sensors) {
      const auto at = std::ranges::find(view.seen, sensor.name, &RigResultView::Seen::sensor);
      row.push_back(at == view.seen.end() ? "" : at->used ? Fixed(at->rms, 2) : "left out");
    }
    table.AddRow(std::move(row));
  }
  std::string text = table.Plain(kTextWidth);
  if (result.views.size() > kMaxViewRows) {
    text += fmt::format("and {} more boards; the result file has all\n",
                        result.views.size() - kMaxViewRows);
  }
  return text;
}

std::string NumberLines(const RigResult& result) {
  std::string text;
  for (const RigResultNumber& number : result.numbers) {
    text += number.sigma ? fmt::format("  {} {}: {:.4f} +- {:.4f}\n", number.sensor, number.name,
                                       number.value, *number.sigma)
                         : fmt::format("  {} {}: {:.2f} times the stated one\n", number.sensor,
                                       number.name, number.value);
  }
  return text;
}

}  // namespace

std::vector<std::string> LoopFindings(const RigResult& result) {
  std::vector<std::string> lines;
  for (const RigResultPair& pair : result.pairs) {
    if (!pair.alone_sigmas || *pair.alone_sigmas <= kMaxLoopSigmas) continue;
    lines.push_back(
        fmt::format("{} and {} alone differ from the answer of all sensors by {:.1f} sigmas",
                    pair.a, pair.b, *pair.alone_sigmas));
  }
  return lines;
}

std::vector<std::string> UnconnectedFindings(const RigResult& result) {
  std::vector<std::string> lines = result.unconnected;
  if (!result.refutations.empty()) return lines;
  for (std::string& line : lines) line += ". The poses of the connected sensors are usable";
  return lines;
}

std::string DescribeRig(const RigResult& result) {
  std::string text = fmt::format("Poses in the frame of {} (root_from_sensor):\n{}", result.root,
                                 SensorTable(result));
  text += "\nEvery pair, by all sensors together and by its own views alone:\n" + PairTable(result);
  if (!result.views.empty()) {
    text += "\nBoards and the sensors that saw them (residual over its stated noise):\n" +
            ViewTable(result);
  }
  if (!result.numbers.empty()) text += "\nEstimated with the poses:\n" + NumberLines(result);
  std::vector<std::string> warnings = UnconnectedFindings(result);
  warnings.insert(warnings.end(), result.warnings.begin(), result.warnings.end());
  for (const std::string& line : LoopFindings(result)) {
    warnings.push_back(fmt::format("{}: {}", line, kLoopCause));
  }
  if (!warnings.empty() || !result.refutations.empty()) text += "\n";
  for (const std::string& warning : warnings) {
    text += Wrapped("warning: " + warning, kTextWidth);
  }
  for (const std::string& reason : result.refutations) {
    text += Wrapped("NOT USABLE: " + reason, kTextWidth);
  }
  return text;
}

}  // namespace sextant
