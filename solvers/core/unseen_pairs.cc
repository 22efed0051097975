// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/unseen_pairs.h"

#include <fmt/core.h>

#include "geometry/lens_domain.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxNotes = 5;

std::string WhyUnseen(const Camera& camera, const Pair2d3d& pair, const Rigid3d& cam_from_lidar) {
  if (!Unproject(camera, pair.pixel)) {
    return fmt::format("no ray of the camera model meets its pixel ({:.6g}, {:.6g}): {}",
                       pair.pixel.x(), pair.pixel.y(), DomainText(camera));
  }
  return "its point does not project: " +
         WhyNotProjected(camera, cam_from_lidar * pair.point_in_lidar);
}

}  // namespace

std::vector<int> PairsWithRay(const CalibrationProblem& problem) {
  std::vector<int> with_ray;
  for (std::size_t i = 0; i < problem.pairs_2d3d.size(); ++i) {
    if (Unproject(*problem.camera, problem.pairs_2d3d[i].pixel)) {
      with_ray.push_back(static_cast<int>(i));
    }
  }
  return with_ray;
}

std::vector<std::string> NotesOnUnseenPairs(const CalibrationProblem& problem, const Camera& camera,
                                            const Rigid3d& cam_from_lidar) {
  std::vector<std::string> notes;
  std::size_t unseen = 0;
  for (std::size_t i = 0; i < problem.pairs_2d3d.size(); ++i) {
    const Pair2d3d& pair = problem.pairs_2d3d[i];
    if (Project(camera, cam_from_lidar * pair.point_in_lidar)) continue;
    if (++unseen > kMaxNotes) continue;
    notes.push_back(fmt::format("pair {} of {} is left out: {}", i + 1, problem.pairs_2d3d.size(),
                                WhyUnseen(camera, pair, cam_from_lidar)));
  }
  if (unseen > kMaxNotes) {
    notes.push_back(fmt::format("{} more pairs are left out for such reasons", unseen - kMaxNotes));
  }
  return notes;
}

}  // namespace sextant
