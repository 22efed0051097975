// SPDX-License-Identifier: Apache-2.0
#include "io/problems/feature_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/nearest_name.h"
#include "base/text/printable.h"
#include "base/units.h"
#include "geometry/coordinate_range.h"
#include "io/problems/csv_header.h"
#include "io/text/line_reader.h"
#include "io/text/max_id.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

using ColumnNames = std::vector<std::string>;

constexpr std::size_t kMaxName = 200;

const ColumnNames& FeatureColumns() {
  static const ColumnNames kNames = {
      "moment", "time_s", "sensor",   "board",    "corner",  "board_x",  "board_y", "side",
      "u",      "v",      "x",        "y",        "z",       "nx",       "ny",      "nz",
      "a",      "b",      "c",        "d",        "dx",      "dy",       "dz",      "x2",
      "y2",     "z2",     "distance", "sigma_px", "sigma_m", "sigma_deg"};
  return kNames;
}

// What other programs call them, as PlainColumn writes it.
const std::map<std::string, std::string, std::less<>>& FeatureAliases() {
  static const std::map<std::string, std::string, std::less<>> kAliases = {
      {"frame", "moment"},
      {"view", "moment"},
      {"scan", "moment"},
      {"sample", "moment"},
      {"pose", "moment"},
      {"time", "time_s"},
      {"times", "time_s"},
      {"stamp", "time_s"},
      {"timestamp", "time_s"},
      {"stamps", "time_s"},
      {"timestamps", "time_s"},
      {"device", "sensor"},
      {"target", "board"},
      {"boardid", "board"},
      {"point", "corner"},
      {"pointid", "corner"},
      {"cornerid", "corner"},
      {"boardx", "board_x"},
      {"boardy", "board_y"},
      {"boardxm", "board_x"},
      {"boardym", "board_y"},
      {"edge", "side"},
      {"line", "side"},
      {"xpx", "u"},
      {"ypx", "v"},
      {"upx", "u"},
      {"vpx", "v"},
      {"pixelx", "u"},
      {"pixely", "v"},
      {"px", "u"},
      {"py", "v"},
      {"xm", "x"},
      {"ym", "y"},
      {"zm", "z"},
      {"normalx", "nx"},
      {"normaly", "ny"},
      {"normalz", "nz"},
      {"distancem", "distance"},
      {"dist", "distance"},
      {"directionx", "dx"},
      {"directiony", "dy"},
      {"directionz", "dz"},
      {"dirx", "dx"},
      {"diry", "dy"},
      {"dirz", "dz"},
      {"x2m", "x2"},
      {"y2m", "y2"},
      {"z2m", "z2"},
      {"sigmapx", "sigma_px"},
      {"sigmam", "sigma_m"},
      {"sigmadeg", "sigma_deg"}};
  return kAliases;
}

std::string FeatureColumn(std::string_view name) {
  const std::string plain = PlainColumn(name);
  const ColumnNames& known = FeatureColumns();
  if (std::ranges::count(known, plain) > 0) return plain;
  const auto alias = FeatureAliases().find(plain);
  return alias == FeatureAliases().end() ? std::string() : alias->second;
}

class FeatureTableReader {
 public:
  explicit FeatureTableReader(LineReader& in) : in_(in) {}

  void ReadHeader() {
    for (std::size_t i = 0; i < in_.field_count() && in_.ok(); ++i) {
      const std::string name = FeatureColumn(in_.Field(i));
      if (name.empty()) {
        in_.Fail(ErrorCode::kParse,
                 fmt::format("unknown column {}; {}", Quoted(in_.Field(i)),
                             SuggestName(PlainColumn(in_.Field(i)), FeatureColumns())));
      } else if (!columns_.emplace(name, i).second) {
        in_.Fail(ErrorCode::kParse, fmt::format("the column {} appears twice", Quoted(name)));
      }
    }
    width_ = in_.field_count();
    if (!Has("sensor")) Missing("sensor");
    if (!Has("moment") && !Has("time_s")) Missing("moment");
    for (const auto& group : kGroups) CheckGroup(group);
  }

  FeatureRow ReadRow() {
    FeatureRow row{.line = in_.line()};
    if (!in_.HasFields(width_, fmt::format("{} values, as the header has", width_))) return row;
    row.moment = Text("moment");
    row.sensor = Text("sensor");
    row.board = Id("board");
    row.corner = Id("corner");
    row.in_board_m = Vector<2>({"board_x", "board_y"});
    row.time_s = Time();
    row.pixel = Vector<2>({"u", "v"});
    row.sigma_px = Sigma("sigma_px");
    row.sigma_m = Sigma("sigma_m");
    row.plane = Plane(row.sigma_m);
    row.position_m = Vector<3>({"x", "y", "z"});
    if (const auto side = Id("side")) row.side = Line(*side, row);
    Check(row);
    return row;
  }

 private:
  static constexpr std::array<std::string_view, 4> kNormal = {"nx", "ny", "nz", "distance"};
  static constexpr std::array<std::string_view, 4> kEquation = {"a", "b", "c", "d"};
  static constexpr std::array<std::array<std::string_view, 4>, 7> kGroups = {
      {{"u", "v"},
       {"x", "y", "z"},
       {"board_x", "board_y"},
       kNormal,
       kEquation,
       {"dx", "dy", "dz"},
       {"x2", "y2", "z2"}}};

  void Missing(std::string_view name) {
    in_.Fail(ErrorCode::kParse,
             fmt::format("expected the columns moment (or time_s), sensor, and corner, side or a "
                         "plane; {} is missing",
                         name));
  }

  // Columns that belong together are all there, or none of them.
  void CheckGroup(const std::array<std::string_view, 4>& group) {
    const auto is_there = [&](std::string_view name) { return !name.empty() && Has(name); };
    if (std::ranges::none_of(group, is_there)) return;
    for (const std::string_view name : group) {
      if (!name.empty() && !Has(name)) {
        in_.Fail(
            ErrorCode::kParse,
            fmt::format("expected the column {} as well: {} belong together", name, Joined(group)));
      }
    }
  }

  static std::string Joined(const std::array<std::string_view, 4>& group) {
    std::string text;
    for (const std::string_view name : group) {
      if (!name.empty()) text += (text.empty() ? "" : ", ") + std::string(name);
    }
    return text;
  }

  bool Has(std::string_view name) const { return columns_.find(name) != columns_.end(); }
  std::size_t Index(std::string_view name) const { return columns_.find(name)->second; }
  std::string Text(std::string_view name) const {
    return Has(name) ? std::string(in_.Field(Index(name))) : std::string();
  }
  bool IsGiven(std::string_view name) const { return Has(name) && !in_.Field(Index(name)).empty(); }

  std::optional<int> Id(std::string_view name) {
    if (!IsGiven(name)) return std::nullopt;
    return static_cast<int>(in_.Integer(Index(name), 0, kMaxId, name));
  }
  std::optional<double> Value(std::string_view name) {
    if (!IsGiven(name)) return std::nullopt;
    return in_.Real(Index(name), name);
  }
  std::optional<double> Time() {
    constexpr double kMaxTime_s = 1e11;  // Year 5138 in seconds; nanoseconds are far beyond.
    const auto time = Value("time_s");
    if (time && std::abs(*time) > kMaxTime_s) {
      in_.Fail(ErrorCode::kParse, "expected a time in seconds; is it in nanoseconds?");
    }
    return time;
  }
  std::optional<double> Sigma(std::string_view name) {
    const auto sigma = Value(name);
    if (sigma && in_.ok() && !(*sigma > 0.0)) {
      in_.Fail(ErrorCode::kParse, fmt::format("expected {} above 0, got {}", name, *sigma));
    }
    return sigma;
  }

  template <int kSize>
  std::optional<Eigen::Matrix<double, kSize, 1>> Vector(
      const std::array<std::string_view, static_cast<std::size_t>(kSize)>& names) {
    const auto given = std::ranges::count_if(names, [&](auto name) { return IsGiven(name); });
    if (given == 0) return std::nullopt;
    Eigen::Matrix<double, kSize, 1> vector;
    for (int i = 0; i < kSize; ++i) {
      const std::string_view name = names[static_cast<std::size_t>(i)];
      if (!IsGiven(name)) {
        in_.Fail(ErrorCode::kParse, fmt::format("expected a value of {} beside {}", name,
                                                names[static_cast<std::size_t>(i == 0 ? 1 : 0)]));
        return std::nullopt;
      }
      vector[i] = in_.Real(Index(name), name);
      if (std::abs(vector[i]) > kMaxCoordinate_m) {
        in_.Fail(ErrorCode::kParse,
                 fmt::format("expected {} of at most {:g}", name, kMaxCoordinate_m));
      }
    }
    return vector;
  }

  // A unit vector from one of any length.
  Eigen::Vector3d Direction(const Eigen::Vector3d& vector, std::string_view what) {
    const double length = vector.norm();
    if (in_.ok() && !(length > 1e-9)) {
      in_.Fail(ErrorCode::kParse, fmt::format("expected {}, not zeros", what));
    }
    return length > 1e-9 ? (vector / length).eval() : Eigen::Vector3d(Eigen::Vector3d::UnitX());
  }

  std::optional<MeasuredPlane> Plane(const std::optional<double>& sigma_m) {
    const auto normal = Vector<4>(kNormal);
    const auto equation = Vector<4>(kEquation);
    if (!normal && !equation) return std::nullopt;
    MeasuredPlane plane;
    // The distance is that of the unit normal, whatever the length of this one; of an equation
    // a x + b y + c z + d = 0 of any length it is -d / |(a, b, c)|.
    const Eigen::Vector4d values = normal ? *normal : *equation;
    plane.normal = Direction(values.head<3>(), "a normal");
    plane.distance_m = normal ? values[3] : -values[3] / std::max(values.head<3>().norm(), 1e-9);
    plane.sigma_m = sigma_m.value_or(plane.sigma_m);
    if (const auto sigma_deg = Sigma("sigma_deg")) plane.sigma_rad = kRadPerDeg * *sigma_deg;
    return plane;
  }

  // Takes the point of the row, which is then no corner.
  std::optional<MeasuredLine> Line(int side, FeatureRow& row) {
    MeasuredLine line{.side = side};
    const auto direction = Vector<3>({"dx", "dy", "dz"});
    const auto second = Vector<3>({"x2", "y2", "z2"});
    if (!row.position_m || (!direction && !second)) {
      in_.Fail(ErrorCode::kParse,
               "a side is a line: expected x, y, z of a point on it, and its direction dx, dy, dz "
               "or a second point x2, y2, z2");
      return std::nullopt;
    }
    line.point = *row.position_m;
    line.direction = direction ? Direction(*direction, "a direction")
                               : Direction(*second - *row.position_m, "two points that differ");
    line.sigma_m = row.sigma_m.value_or(line.sigma_m);
    row.position_m.reset();
    return line;
  }

  void Check(const FeatureRow& row) {
    if (!in_.ok()) return;
    const bool is_point = row.pixel || row.position_m;
    if (row.sensor.empty()) return in_.Fail(ErrorCode::kParse, "expected the name of the sensor");
    if (Printable(row.moment, kMaxName) != row.moment) {
      return in_.Fail(ErrorCode::kParse, fmt::format("expected a moment of at most {} characters "
                                                     "that can be printed",
                                                     kMaxName));
    }
    if (row.moment.empty() && !row.time_s) {
      return in_.Fail(ErrorCode::kParse, "expected a moment, or a time");
    }
    if (!is_point && !row.plane && !row.side) {
      return in_.Fail(ErrorCode::kParse,
                      "the row has neither a pixel, a point, a plane nor the line of a side");
    }
    if (is_point && !row.corner && !row.in_board_m) {
      in_.Fail(ErrorCode::kParse,
               "expected the number of the corner that was measured, from 0, or board_x, board_y");
    }
  }

  LineReader& in_;
  std::map<std::string, std::size_t, std::less<>> columns_;
  std::size_t width_ = 0;
};

}  // namespace

Expected<std::vector<FeatureRow>> ReadFeatureTable(const std::filesystem::path& path) {
  return ReadWith(path, ParseFeatureTable);
}

Expected<std::vector<FeatureRow>> ParseFeatureTable(std::string_view text,
                                                    const std::string& file) {
  const CsvText csv(text);
  LineReader in(file, csv.text(), csv.separator());
  if (!in.Require("a header line with the names of the columns")) return in.TakeError();
  FeatureTableReader reader(in);
  reader.ReadHeader();
  std::vector<FeatureRow> rows;
  while (in.Next()) rows.push_back(reader.ReadRow());
  if (!in.ok()) return in.TakeError();
  return rows;
}

}  // namespace sextant
