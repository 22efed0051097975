// SPDX-License-Identifier: Apache-2.0
#include "simulator/lidar/lidar_model.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <numbers>

#include "base/nearest_name.h"
#include "simulator/lidar/lidar_models.h"

namespace sextant {
namespace {

struct LidarModelEntry {
  const char* name;
  LidarModel (*make)();
};

constexpr std::array kEntries = {
    LidarModelEntry{"vlp16", Vlp16},
    LidarModelEntry{"hdl32e", Hdl32e},
    LidarModelEntry{"hdl64e", Hdl64e},
    LidarModelEntry{"os1_64", Os1With64Rings},
    LidarModelEntry{"os1_128", Os1With128Rings},
    LidarModelEntry{"pandar40p", Pandar40p},
    LidarModelEntry{"livox", LivoxMid40},
};

}  // namespace

double FromDegrees(double degrees) { return degrees * std::numbers::pi / 180.0; }

int ColumnCount(const LidarModel& model) {
  // If a revolution is not a whole number of columns, it ends with the last complete one. The
  // offset keeps rounding of the quotient from losing a column.
  return static_cast<int>(std::floor(model.turn_period_s / model.column_period_s + 1e-6));
}

const std::vector<std::string>& LidarModelNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const LidarModelEntry& entry : kEntries) all.emplace_back(entry.name);
    return all;
  }();
  return names;
}

Expected<LidarModel> FindLidarModel(std::string_view name) {
  for (const LidarModelEntry& entry : kEntries) {
    if (name != entry.name) continue;
    LidarModel model = entry.make();
    model.name = entry.name;
    return model;
  }
  return MakeError(ErrorCode::kUnknownName, fmt::format("no LiDAR model is named '{}'; {}", name,
                                                        SuggestName(name, LidarModelNames())));
}

}  // namespace sextant
