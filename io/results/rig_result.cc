// SPDX-License-Identifier: Apache-2.0
#include "io/results/rig_result.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text/printable.h"
#include "io/blocks/json_blocks.h"

namespace sextant {
namespace {

using RigJson = nlohmann::ordered_json;

constexpr const char* kFirstKey = "sextant_rig_result";

RigJson CovarianceJson(const Matrix6d& covariance) {
  RigJson rows = RigJson::array();
  for (int i = 0; i < 6; ++i) {
    RigJson row = RigJson::array();
    for (int j = 0; j < 6; ++j) row.push_back(covariance(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

RigJson SigmasJson(const Matrix6d& covariance) {
  RigJson sigmas = RigJson::array();
  for (int i = 0; i < 6; ++i) sigmas.push_back(std::sqrt(covariance(i, i)));
  return sigmas;
}

void AddUncertainty(const std::optional<Matrix6d>& covariance, RigJson& json) {
  if (!covariance) return;
  json["sigma_rad_m"] = SigmasJson(*covariance);
  json["covariance"] = CovarianceJson(*covariance);
}

RigJson SensorJson(const RigResultSensor& sensor) {
  RigJson json = {{"name", sensor.name}};
  if (sensor.camera) json["camera"] = CameraJson(*sensor.camera);
  json["root_from_sensor"] =
      sensor.root_from_sensor ? PoseJson(*sensor.root_from_sensor) : RigJson();
  AddUncertainty(sensor.covariance, json);
  json["views"] = sensor.views;
  json["views_used"] = sensor.used;
  if (sensor.true_root_from_sensor) {
    json["true_root_from_sensor"] = PoseJson(*sensor.true_root_from_sensor);
  }
  return json;
}

RigJson PairJson(const RigResultPair& pair) {
  RigJson json = {{"a", pair.a}, {"b", pair.b}, {"a_from_b", PoseJson(pair.a_from_b)}};
  AddUncertainty(pair.covariance, json);
  json["views"] = pair.views;
  if (!pair.alone_a_from_b) return json;
  RigJson alone = {{"a_from_b", PoseJson(*pair.alone_a_from_b)}};
  AddUncertainty(pair.alone_covariance, alone);
  if (pair.alone_sigmas) alone["off_sigmas"] = *pair.alone_sigmas;
  json["alone"] = std::move(alone);
  return json;
}

RigJson ViewJson(const RigResultView& view) {
  RigJson seen = RigJson::array();
  for (const RigResultView::Seen& one : view.seen) {
    seen.push_back({{"sensor", one.sensor}, {"used", one.used}, {"rms", one.rms}});
  }
  return {{"moment", view.moment}, {"board", view.board}, {"seen", std::move(seen)}};
}

}  // namespace

const RigResultSensor* RigResult::Find(std::string_view name) const {
  const auto at = std::ranges::find(sensors, name, &RigResultSensor::name);
  return at == sensors.end() ? nullptr : &*at;
}

Expected<Rigid3d> RigResult::Between(std::string_view a, std::string_view b) const {
  Rigid3d a_from_root;
  Rigid3d root_from_b;
  for (const std::string_view name : {a, b}) {
    const RigResultSensor* sensor = Find(name);
    if (sensor == nullptr) {
      std::string known;
      for (const RigResultSensor& one : sensors) known += (known.empty() ? "" : ", ") + one.name;
      return MakeError(ErrorCode::kUnknownName,
                       fmt::format("no sensor {}; there are: {}", Quoted(name), known));
    }
    if (!sensor->root_from_sensor) {
      return MakeError(ErrorCode::kMissingData,
                       fmt::format("sensor {} is not connected with the others", Quoted(name)));
    }
    (name == a ? a_from_root : root_from_b) =
        name == a ? sensor->root_from_sensor->Inverse() : *sensor->root_from_sensor;
  }
  if (a == b) return Rigid3d{};
  return a_from_root * root_from_b;
}

std::string FormatRigResult(const RigResult& result) {
  RigJson json = {{kFirstKey, 1}, {"version", result.version}, {"root", result.root}};
  json["sensors"] = RigJson::array();
  for (const RigResultSensor& sensor : result.sensors)
    json["sensors"].push_back(SensorJson(sensor));
  json["pairs"] = RigJson::array();
  for (const RigResultPair& pair : result.pairs) json["pairs"].push_back(PairJson(pair));
  json["views"] = RigJson::array();
  for (const RigResultView& view : result.views) json["views"].push_back(ViewJson(view));
  json["numbers"] = RigJson::array();
  for (const RigResultNumber& number : result.numbers) {
    RigJson one = {{"sensor", number.sensor}, {"name", number.name}, {"value", number.value}};
    if (number.sigma) one["sigma"] = *number.sigma;
    json["numbers"].push_back(std::move(one));
  }
  json["unconnected"] = result.unconnected;
  json["warnings"] = result.warnings;
  json["not_usable"] = result.refutations;
  return json.dump(2, ' ', false, RigJson::error_handler_t::replace) + "\n";
}

bool IsRigResult(std::string_view text) {
  const std::size_t at = text.find_first_not_of("{ \t\r\n\"");
  return at != std::string_view::npos && text.substr(at).starts_with(kFirstKey);
}

}  // namespace sextant
