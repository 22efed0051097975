// SPDX-License-Identifier: Apache-2.0
#include "report/collect/rig_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/units.h"
#include "calibrate/trust/information.h"
#include "eval/statistics/text_table.h"
#include "geometry/scan_marks.h"
#include "geometry/so3.h"
#include "report/collect/page_views.h"
#include "report/rig_text.h"

namespace sextant {
namespace {

std::string LeastCertain(const std::optional<Matrix6d>& covariance) {
  if (!covariance) return "–";
  const WeakestDirections weakest = WeakestOf(*covariance);
  return fmt::format("{:.2f} mm, {:.3f} deg", 1e3 * weakest.translation_sigma_m,
                     kDegPerRad * weakest.rotation_sigma_rad);
}

std::string PositionInMm(const Rigid3d& pose) {
  const Eigen::Vector3d mm = 1e3 * pose.translation;
  return fmt::format("{:.1f}, {:.1f}, {:.1f}", mm.x(), mm.y(), mm.z());
}

std::string AnglesInDeg(const Rigid3d& pose) {
  const EulerZyx euler = ToEulerZyx(pose.rotation);
  return fmt::format("{:.2f}, {:.2f}, {:.2f}", kDegPerRad * euler.yaw, kDegPerRad * euler.pitch,
                     kDegPerRad * euler.roll);
}

PageVerdict RigVerdictOf(const RigResult& result) {
  if (!result.refutations.empty()) {
    return {PageTone::kBad, "NOT USABLE", result.refutations.front(),
            "Correct that and calibrate again"};
  }
  if (!result.unconnected.empty()) {
    return {PageTone::kCaution, "USABLE WITH CARE", UnconnectedFindings(result).front(),
            "To have the pose of every sensor, record that and calibrate again"};
  }
  if (const auto off = LoopFindings(result); !off.empty()) {
    return {PageTone::kCaution, "USABLE WITH CARE", off.front(),
            fmt::format("Look for {}", kLoopCause)};
  }
  if (!result.warnings.empty()) {
    return {PageTone::kCaution, "USABLE WITH CARE", result.warnings.front(),
            "Read below what the checks found"};
  }
  const bool has_loops = std::ranges::any_of(
      result.pairs, [](const RigResultPair& pair) { return pair.alone_sigmas.has_value(); });
  if (!has_loops) {
    return {PageTone::kNeutral, "NOT CHECKED",
            "No two sensors determine their pose by their own views, so nothing independent "
            "confirms the answer",
            "Record boards that more sensors see together"};
  }
  return {PageTone::kGood, "NO FAULT FOUND",
          fmt::format("Each pair of sensors that can be calibrated alone agrees with the answer of "
                      "all sensors within {:g} sigmas",
                      kMaxLoopSigmas),
          "Compare the sigmas below with the accuracy that you need"};
}

const RigResultPair* WeakestPair(const RigResult& result) {
  const RigResultPair* weakest = nullptr;
  double sigma = -1.0;
  for (const RigResultPair& pair : result.pairs) {
    if (!pair.covariance) continue;
    const double its = WeakestOf(*pair.covariance).translation_sigma_m;
    if (its > sigma) {
      sigma = its;
      weakest = &pair;
    }
  }
  return weakest;
}

std::vector<PageFigure> RigFiguresOf(const RigResult& result) {
  const auto connected = std::ranges::count_if(result.sensors, [](const RigResultSensor& sensor) {
    return sensor.root_from_sensor.has_value();
  });
  std::vector<PageFigure> figures = {{"Sensors",
                                      fmt::format("{} of {}", connected, result.sensors.size()),
                                      "connected with " + result.root}};
  if (const RigResultPair* pair = WeakestPair(result)) {
    const WeakestDirections weakest = WeakestOf(*pair->covariance);
    const std::string note = fmt::format("1 sigma of {} and {}", pair->a, pair->b);
    figures.push_back(
        {"Least certain translation", Fixed(1e3 * weakest.translation_sigma_m, 2) + " mm", note});
    figures.push_back({"Its rotation", Fixed(kDegPerRad * weakest.rotation_sigma_rad, 3) + " deg",
                       "1 sigma of the least certain direction"});
  }
  if (!result.views.empty()) {
    figures.push_back({"Boards", std::to_string(result.views.size()), "by sensors and moments"});
  }
  return figures;
}

PageTable RigSensorTable(const RigResult& result) {
  PageTable table{.header = {"Sensor", "Kind", "Boards used", "Position [mm]",
                             "Yaw, pitch, roll [deg]", "1 sigma"},
                  .words = 2,
                  .note = "In the frame of " + result.root +
                          ". 1 sigma: the least certain direction. Boards: those that the sensor "
                          "sees together with another one."};
  for (const RigResultSensor& sensor : result.sensors) {
    const bool is_root = sensor.name == result.root;
    std::vector<std::string> row = {sensor.name, sensor.camera ? "camera" : "3D sensor",
                                    fmt::format("{} of {}", sensor.used, sensor.views)};
    if (sensor.root_from_sensor) {
      row.insert(row.end(),
                 {PositionInMm(*sensor.root_from_sensor), AnglesInDeg(*sensor.root_from_sensor),
                  is_root ? "root" : LeastCertain(sensor.covariance)});
    } else {
      row.insert(row.end(), {"not connected", "–", "–"});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

PageTable RigPairTable(const RigResult& result) {
  PageTable table{.header = {"Pair", "Boards", "Position [mm]", "1 sigma", "1 sigma alone",
                             "Alone differs by", "In sigmas"},
                  .note =
                      "Alone: by the views of these two sensors only, as an independent check. "
                      "About 1 sigma or less: they agree."};
  for (const RigResultPair& pair : result.pairs) {
    std::string differs = "–";
    if (pair.alone_a_from_b) {
      const PoseDistance off = DistanceBetween(*pair.alone_a_from_b, pair.a_from_b);
      differs = fmt::format("{:.2f} mm, {:.3f} deg", 1e3 * off.translation_m,
                            kDegPerRad * off.rotation_rad);
    }
    table.rows.push_back({pair.a + "_from_" + pair.b, std::to_string(pair.views),
                          PositionInMm(pair.a_from_b), LeastCertain(pair.covariance),
                          LeastCertain(pair.alone_covariance), differs,
                          pair.alone_sigmas ? Fixed(*pair.alone_sigmas, 1) : "–"});
  }
  if (table.rows.empty()) table.note.clear();
  return table;
}

PageTable RigBoardTable(const RigResult& result) {
  PageTable table{.header = {"Moment", "Board"}, .words = 2};
  if (result.views.empty()) return table;
  table.note =
      "The residuals of each sensor over their stated noise: about 1 where it is right. A dash: "
      "not "
      "seen.";
  for (const RigResultSensor& sensor : result.sensors) table.header.push_back(sensor.name);
  for (const RigResultView& view : result.views) {
    std::vector<std::string> row = {view.moment, std::to_string(view.board)};
    for (const RigResultSensor& sensor : result.sensors) {
      const auto at = std::ranges::find(view.seen, sensor.name, &RigResultView::Seen::sensor);
      row.push_back(at == view.seen.end() ? "–" : at->used ? Fixed(at->rms, 2) : "left out");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

PageTable RigNumberTable(const RigResult& result) {
  PageTable table{.header = {"Sensor", "Parameter", "Value", "1 sigma"}, .words = 2};
  for (const RigResultNumber& number : result.numbers) {
    table.rows.push_back({number.sensor, number.name, fmt::format("{:.4f}", number.value),
                          number.sigma ? fmt::format("{:.4f}", *number.sigma) : "–"});
  }
  if (!table.rows.empty()) table.note = "Lengths in metres; noise: times the stated one.";
  return table;
}

// The frame of the page: the first LiDAR or, without one, the root's place with x forward.
Rigid3d BaseFromRoot(const RigResult& result) {
  for (const RigResultSensor& sensor : result.sensors) {
    if (!sensor.camera && sensor.root_from_sensor) return sensor.root_from_sensor->Inverse();
  }
  return AxesCamFromLidar().Inverse();
}

std::vector<PageTransform> RigTransformsOf(const RigResult& result) {
  std::vector<PageTransform> transforms;
  for (const RigResultSensor& sensor : result.sensors) {
    if (!sensor.root_from_sensor || sensor.name == result.root) continue;
    PageTransform transform{
        .from = sensor.name, .to = result.root, .to_from_from = *sensor.root_from_sensor};
    if (sensor.covariance) transform.sigma = sensor.covariance->diagonal().cwiseSqrt();
    transforms.push_back(std::move(transform));
  }
  return transforms;
}

}  // namespace

ReportPage CollectRigPage(const RigResult& result) {
  ReportPage page{.kind = "Rig report",
                  .version = result.version,
                  .verdict = RigVerdictOf(result),
                  .figures = RigFiguresOf(result),
                  .transforms = RigTransformsOf(result)};
  const Rigid3d base_from_root = BaseFromRoot(result);
  for (const RigResultSensor& sensor : result.sensors) {
    page.title += (page.title.empty() ? "" : ", ") + sensor.name;
    PageSensor shown =
        sensor.camera ? PageCameraOf(sensor.name, *sensor.camera) : PageSensor{.name = sensor.name};
    if (sensor.root_from_sensor) shown.base_from_sensor = base_from_root * *sensor.root_from_sensor;
    page.sensors.push_back(std::move(shown));
  }
  page.sections = {
      {"sensors", "The sensors", "Sensors", {}, RigSensorTable(result)},
      {"pairs", "Every pair of sensors", "Pairs", {}, RigPairTable(result)},
      {"boards", "The boards", "Boards", {}, RigBoardTable(result)},
      {"estimated", "Estimated with the poses", "Estimated", {}, RigNumberTable(result)}};
  page.diagnostics = result.refutations;
  for (const auto& lines : {UnconnectedFindings(result), result.warnings, LoopFindings(result)}) {
    page.diagnostics.insert(page.diagnostics.end(), lines.begin(), lines.end());
  }
  return page;
}

}  // namespace sextant
