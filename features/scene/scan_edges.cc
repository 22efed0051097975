// SPDX-License-Identifier: Apache-2.0
#include "features/scene/scan_edges.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/median.h"
#include "features/scene/scan_sweeps.h"

namespace sextant {
namespace {

constexpr double kMaxRange_m = 60.0;
constexpr double kMaxSweepGap_rad = 0.06;
constexpr double kSameAzimuth_rad = 0.004;

class EdgeFinder {
 public:
  EdgeFinder(const PointCloud& scan, const ScanSweeps& sweeps) : scan_(scan), sweeps_(sweeps) {
    std::vector<double> steps = {0.0};
    for (const std::vector<int>& sweep : sweeps) {
      for (std::size_t i = 1; i < sweep.size(); i += 7) {
        steps.push_back((Direction(sweep[i]) - Direction(sweep[i - 1])).norm());
      }
    }
    step_rad_ = UpperMedian(steps);
  }

  std::vector<ScanEdge> Find() {
    for (const std::vector<int>& sweep : sweeps_) AddAlong(sweep);
    SortByAzimuth();
    for (int i = 0; i < static_cast<int>(sweeps_.size()); ++i) {
      AddBetween(i, 1);
      AddBetween(i, -1);
    }
    return std::move(edges_);
  }

 private:
  using Place = std::pair<double, int>;  // Azimuth and index.

  double Range(int i) const { return scan_.points[static_cast<std::size_t>(i)].norm(); }
  Eigen::Vector3d Direction(int i) const {
    return scan_.points[static_cast<std::size_t>(i)].normalized();
  }

  void Add(int near, int far, bool is_between_sweeps) {
    const Eigen::Vector3d a = Direction(near);
    const Eigen::Vector3d b = Direction(far);
    edges_.push_back({.point = Range(near) * (a + b).normalized(),
                      .across = (b - a).normalized(),
                      .gap_rad = (b - a).norm(),
                      .is_between_sweeps = is_between_sweeps});
  }

  void AddAlong(const std::vector<int>& sweep) {
    std::vector<double> r;
    for (const int i : sweep) r.push_back(Range(i));
    for (std::size_t i = 2; i + 3 < sweep.size(); ++i) {
      const bool first_is_near = r[i] < r[i + 1];
      const double near = std::min(r[i], r[i + 1]);
      const double jump = std::abs(r[i + 1] - r[i]);
      if (near > kMaxRange_m || jump < std::max(0.3, 0.05 * near)) continue;
      if ((Direction(sweep[i]) - Direction(sweep[i + 1])).norm() > 3.0 * step_rad_) continue;
      const double beside = std::abs(first_is_near ? r[i] - r[i - 1] : r[i + 2] - r[i + 1]);
      const double further = std::abs(first_is_near ? r[i - 1] - r[i - 2] : r[i + 3] - r[i + 2]);
      if (beside > 0.2 * jump || further > 0.3 * jump) continue;
      Add(sweep[first_is_near ? i : i + 1], sweep[first_is_near ? i + 1 : i], false);
    }
  }

  void SortByAzimuth() {
    for (const std::vector<int>& sweep : sweeps_) {
      std::vector<Place>& sorted = by_azimuth_.emplace_back();
      for (const int i : sweep) {
        const Eigen::Vector3d& p = scan_.points[static_cast<std::size_t>(i)];
        sorted.emplace_back(std::atan2(p.y(), p.x()), i);
      }
      std::ranges::sort(sorted);
    }
  }

  // The return of a sweep at an azimuth; -1 if there is none.
  int At(int sweep, double azimuth) const {
    if (sweep < 0 || sweep >= static_cast<int>(by_azimuth_.size())) return -1;
    const std::vector<Place>& sorted = by_azimuth_[static_cast<std::size_t>(sweep)];
    auto next = std::ranges::lower_bound(sorted, azimuth, {}, &Place::first);
    int found = -1;
    double nearest = kSameAzimuth_rad;
    for (int k = 0; k < 2; ++k) {
      if (next != sorted.end() && std::abs(next->first - azimuth) < nearest) {
        nearest = std::abs(next->first - azimuth);
        found = next->second;
      }
      if (next == sorted.begin()) break;
      --next;
    }
    return found;
  }

  // Where the next sweep passes over (or under) an upright surface, to one far behind it.
  void AddBetween(int sweep, int towards) {
    const std::vector<Place>& places = by_azimuth_[static_cast<std::size_t>(sweep)];
    for (std::size_t k = 1; k + 1 < places.size(); ++k) {
      const auto [azimuth, near] = places[k];
      const double r = Range(near);
      const int far = At(sweep + towards, azimuth);
      if (r > kMaxRange_m || far < 0 || Range(far) - r < std::max(0.5, 0.1 * r)) continue;
      const int behind = At(sweep - towards, azimuth);
      const double most = std::min(0.2 * (Range(far) - r), 0.15 + 0.02 * r);
      if (behind < 0 || std::abs(Range(behind) - r) > most) continue;
      const bool is_smooth = std::abs(Range(places[k - 1].second) - r) < 0.3 &&
                             std::abs(Range(places[k + 1].second) - r) < 0.3;
      const double gap = (Direction(far) - Direction(near)).norm();
      if (is_smooth && gap < kMaxSweepGap_rad) Add(near, far, true);
    }
  }

  const PointCloud& scan_;
  const ScanSweeps& sweeps_;
  double step_rad_ = 0.0;
  std::vector<std::vector<Place>> by_azimuth_;
  std::vector<ScanEdge> edges_;
};

}  // namespace

Expected<std::vector<ScanEdge>> FindScanEdges(const PointCloud& scan) {
  SEXTANT_ASSIGN_OR_RETURN(const ScanSweeps sweeps, FindSweeps(scan));
  return EdgeFinder(scan, sweeps).Find();
}

}  // namespace sextant
