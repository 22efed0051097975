// SPDX-License-Identifier: Apache-2.0
#include "io/results/imported_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "base/nearest_name.h"
#include "geometry/coordinate_range.h"
#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

const std::vector<std::string>& PoseColumnNames() {
  static const std::vector<std::string> kNames = {
      "solver", "x", "y", "z", "qw", "qx", "qy", "qz", "condition", "trial", "time_us"};
  return kNames;
}
constexpr std::size_t kRequiredColumns = 8;

/// The place of each known column in a row.
class PoseColumns {
 public:
  explicit PoseColumns(LineReader& in) : in_(in), places_(PoseColumnNames().size(), kAbsent) {
    const std::vector<std::string>& known = PoseColumnNames();
    if (!in.Require("a header line: " + fmt::format("{}", fmt::join(known, ",")))) return;
    count_ = in.field_count();
    for (std::size_t i = 0; i < count_ && in.ok(); ++i) Add(std::string(in.Field(i)), i);
    for (std::size_t k = 0; k < kRequiredColumns; ++k) {
      if (places_[k] == kAbsent) {
        in.Fail(ErrorCode::kParse, fmt::format("the column {} is missing", known[k]));
      }
    }
  }

  std::size_t count() const { return count_; }
  bool Has(std::string_view name) const { return Place(name) != kAbsent; }
  std::string Text(std::string_view name) const {
    return Has(name) ? std::string(in_.Field(Place(name))) : std::string();
  }
  double Real(std::string_view name) { return in_.Real(Place(name), name); }
  std::uint64_t Count(std::string_view name) {
    if (!Has(name)) return 0;
    constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
    return static_cast<std::uint64_t>(in_.Integer(Place(name), 0, kMax, name));
  }

 private:
  static constexpr std::size_t kAbsent = std::numeric_limits<std::size_t>::max();

  void Add(const std::string& name, std::size_t place) {
    const std::vector<std::string>& known = PoseColumnNames();
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      in_.Fail(ErrorCode::kParse,
               fmt::format("unknown column {}; {}", Quoted(name), SuggestName(name, known)));
      return;
    }
    std::size_t& known_place = places_[static_cast<std::size_t>(found - known.begin())];
    if (known_place != kAbsent) {
      in_.Fail(ErrorCode::kParse, fmt::format("the column {} appears twice", name));
    }
    known_place = place;
  }

  std::size_t Place(std::string_view name) const {
    const auto& known = PoseColumnNames();
    return places_[static_cast<std::size_t>(std::find(known.begin(), known.end(), name) -
                                            known.begin())];
  }

  LineReader& in_;
  std::vector<std::size_t> places_;
  std::size_t count_ = 0;
};

Rigid3d ReadImportedPose(LineReader& in, PoseColumns& row) {
  const double x = row.Real("x");
  const double y = row.Real("y");
  const double z = row.Real("z");
  const double w = row.Real("qw");
  const double qx = row.Real("qx");
  const double qy = row.Real("qy");
  const double qz = row.Real("qz");
  const Eigen::Quaterniond rotation(w, qx, qy, qz);
  if (in.ok() && !(std::abs(rotation.norm() - 1.0) < 1e-3)) {
    in.Fail(ErrorCode::kParse,
            fmt::format("expected a quaternion of length 1, got {:.4g}", rotation.norm()));
  }
  const Eigen::Vector3d translation(x, y, z);
  if (!(translation.cwiseAbs().maxCoeff() <= kMaxCoordinate_m)) {
    in.Fail(ErrorCode::kParse,
            fmt::format("expected a translation of at most {:g} m", kMaxCoordinate_m));
  }
  return {rotation.normalized(), translation};
}

}  // namespace

Expected<std::vector<ImportedPose>> ReadImportedPoses(const std::filesystem::path& path) {
  return ReadWith(path, ParseImportedPoses);
}

Expected<std::vector<ImportedPose>> ParseImportedPoses(std::string_view text,
                                                       const std::string& file) {
  LineReader in(file, text, LineReader::Separator::kCommas);
  PoseColumns row(in);
  const std::string form = fmt::format("{} values", row.count());
  std::vector<ImportedPose> poses;
  std::set<std::tuple<std::string, std::string, std::uint64_t>> seen;
  while (in.Next() && in.HasFields(row.count(), form)) {
    ImportedPose& pose = poses.emplace_back();
    pose.solver = row.Text("solver");
    pose.cam_from_lidar = ReadImportedPose(in, row);
    pose.condition = row.Text("condition");
    pose.trial = row.Count("trial");
    if (row.Has("time_us")) pose.time_us = row.Real("time_us");
    if (pose.solver.empty()) in.Fail(ErrorCode::kParse, "the solver has no name");
    if (!seen.emplace(pose.solver, pose.condition, pose.trial).second) {
      in.Fail(ErrorCode::kParse,
              fmt::format("a second pose of {} for the same problem", Quoted(pose.solver)));
    }
  }
  if (in.ok() && poses.empty()) in.Fail(ErrorCode::kParse, "expected poses after the header");
  if (!in.ok()) return in.TakeError();
  return poses;
}

}  // namespace sextant
