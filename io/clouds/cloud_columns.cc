// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/cloud_columns.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "io/text/number_text.h"

namespace sextant {
namespace {

using ColumnMember = std::size_t CloudColumns::*;

constexpr double kByType =
    0.0;  // Seconds in a floating-point column, nanoseconds in an integer one.

struct KnownName {
  std::string_view name;
  ColumnMember column;
  double time_unit_s = kByType;
};

// If several names of one field are present, the first in this list is used.
constexpr std::array kKnownNames = {
    KnownName{"x", &CloudColumns::x},
    KnownName{"y", &CloudColumns::y},
    KnownName{"z", &CloudColumns::z},
    KnownName{"points_m_xyz:0", &CloudColumns::x},
    KnownName{"points_m_xyz:1", &CloudColumns::y},
    KnownName{"points_m_xyz:2", &CloudColumns::z},
    KnownName{"points:0", &CloudColumns::x},
    KnownName{"points:1", &CloudColumns::y},
    KnownName{"points:2", &CloudColumns::z},
    KnownName{"point_x", &CloudColumns::x},
    KnownName{"point_y", &CloudColumns::y},
    KnownName{"point_z", &CloudColumns::z},
    KnownName{"intensity", &CloudColumns::intensity},
    KnownName{"reflectivity", &CloudColumns::intensity},
    KnownName{"remission", &CloudColumns::intensity},
    KnownName{"i", &CloudColumns::intensity},
    KnownName{"ring", &CloudColumns::ring},
    KnownName{"laser_id", &CloudColumns::ring},
    KnownName{"channel", &CloudColumns::ring},
    KnownName{"line", &CloudColumns::ring},
    KnownName{"time", &CloudColumns::time},
    KnownName{"t", &CloudColumns::time},
    KnownName{"time_us", &CloudColumns::time, 1e-6},
    KnownName{"time_ns", &CloudColumns::time, 1e-9},
    KnownName{"offset_time", &CloudColumns::time, 1e-9},
    KnownName{"adjustedtime", &CloudColumns::time, 1e-6},
    KnownName{"timestamp", &CloudColumns::time},
    KnownName{"time_stamp", &CloudColumns::time},
};

std::string Normalised(std::string_view name) {
  std::string lower;
  for (const char c : name) {
    if (c != '"') lower += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  constexpr std::string_view kCloudCompare = "scalar_";
  if (lower.starts_with(kCloudCompare)) lower.erase(0, kCloudCompare.size());
  if (lower.starts_with("//")) lower.erase(0, 2);  // CloudCompare's first line begins so.
  for (const std::string_view unit : {"[m]", "(m)"}) {
    if (!lower.ends_with(unit)) continue;
    lower.resize(lower.size() - unit.size());
    lower.resize(lower.find_last_not_of(' ') + 1);
  }
  return lower;
}

std::string Listed(std::span<const NamedColumn> columns) {
  std::string names;
  for (const NamedColumn& column : columns) {
    if (names.size() > 100) return names + ", ...";
    names += (names.empty() ? "" : ", ") + Printable(column.name, 30);
  }
  return names.empty() ? "none" : names;
}

}  // namespace

Expected<CloudColumns> FindCloudColumns(std::span<const NamedColumn> columns) {
  CloudColumns found;
  std::array<std::size_t, kKnownNames.size()> place;
  place.fill(CloudColumns::kNone);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string name = Normalised(columns[i].name);
    for (std::size_t k = 0; k < kKnownNames.size(); ++k) {
      if (kKnownNames[k].name != name) continue;
      if (place[k] != CloudColumns::kNone) {
        return MakeError(ErrorCode::kParse,
                         fmt::format("the column {} appears twice", Quoted(columns[i].name)));
      }
      place[k] = i;
    }
  }
  const bool is_livox = std::ranges::any_of(
      columns, [](const NamedColumn& column) { return Normalised(column.name) == "tag"; });
  for (std::size_t k = 0; k < kKnownNames.size(); ++k) {
    const KnownName& known = kKnownNames[k];
    if (is_livox && known.name == "line") continue;
    if (place[k] == CloudColumns::kNone || found.*known.column != CloudColumns::kNone) continue;
    found.*known.column = place[k];
    if (known.column != &CloudColumns::time) continue;
    found.time_unit_s = known.time_unit_s;
    if (known.time_unit_s == kByType) found.time_unit_s = columns[place[k]].is_integer ? 1e-9 : 1.0;
  }
  for (const auto& [column, name] :
       {std::pair{&CloudColumns::x, "x"}, {&CloudColumns::y, "y"}, {&CloudColumns::z, "z"}}) {
    if (found.*column != CloudColumns::kNone) continue;
    return MakeError(ErrorCode::kParse, fmt::format("expected columns x, y and z; {} is missing, "
                                                    "the columns are: {}",
                                                    name, Listed(columns)));
  }
  return found;
}

CloudColumns UnnamedColumns(std::size_t columns, bool fifth_is_ring) {
  CloudColumns found{.x = 0, .y = 1, .z = 2};
  if (columns == 4 || columns == 5) found.intensity = 3;
  if (columns == 5 && fifth_is_ring) found.ring = 4;
  return found;
}

bool IsRingNumber(double value) {
  return value >= 0.0 && value <= 65535.0 && value == std::floor(value);
}

}  // namespace sextant
