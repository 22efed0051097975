// SPDX-License-Identifier: Apache-2.0
#include "solvers/matching/correspondence_model.h"

#include <algorithm>

#include "solvers/kernels/kabsch.h"
#include "solvers/kernels/p3p.h"
#include "solvers/least_squares/refine_pose.h"

namespace sextant {
namespace {

std::size_t Slot(int index) { return static_cast<std::size_t>(index); }

class PointModel final : public CorrespondenceModel {
 public:
  explicit PointModel(std::span<const Pair3d3d> pairs) {
    for (const Pair3d3d& pair : pairs) {
      observed_.push_back(pair.point_in_cam);
      in_lidar_.push_back(pair.point_in_lidar);
    }
  }

  int dimension() const override { return 3; }

  std::optional<Eigen::Vector3d> Predict(const Rigid3d& cam_from_lidar,
                                         const Eigen::Vector3d& in_lidar) const override {
    return cam_from_lidar * in_lidar;
  }

  void AddPosesOf(const Triple& cam, const Triple& lidar,
                  std::vector<Rigid3d>& poses) const override {
    std::array<Correspondence, 3> three;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const double in_cam = (observed_[Slot(cam[i])] - observed_[Slot(cam[j])]).norm();
      const double in_lidar = (in_lidar_[Slot(lidar[i])] - in_lidar_[Slot(lidar[j])]).norm();
      // A rigid motion keeps lengths; half leaves room for any noise with which orders differ.
      if (std::abs(in_cam - in_lidar) > 0.5 * std::max(in_cam, in_lidar)) return;
      three[i] = {cam[i], lidar[i]};
    }
    if (const auto fit = Fit(three, {})) poses.push_back(fit->cam_from_lidar);
  }

  std::optional<CorrespondenceFit> Fit(std::span<const Correspondence> correspondences,
                                       const Rigid3d& /*start*/) const override {
    std::vector<Eigen::Vector3d> in_cam;
    std::vector<Eigen::Vector3d> in_lidar;
    for (const Correspondence& c : correspondences) {
      in_cam.push_back(observed_[Slot(c.cam)]);
      in_lidar.push_back(in_lidar_[Slot(c.lidar)]);
    }
    const Expected<KabschFit> fit = FitKabsch(in_cam, in_lidar);
    if (!fit) return std::nullopt;
    return CorrespondenceFit{fit->b_from_a, fit->sum_squares};
  }
};

class PixelModel final : public CorrespondenceModel {
 public:
  PixelModel(std::span<const Pair2d3d> pairs, const Camera& camera) : camera_(camera) {
    for (const Pair2d3d& pair : pairs) {
      observed_.emplace_back(pair.pixel.x(), pair.pixel.y(), 0.0);
      in_lidar_.push_back(pair.point_in_lidar);
      rays_.push_back(Unproject(camera, pair.pixel));
    }
  }

  int dimension() const override { return 2; }

  std::optional<Eigen::Vector3d> Predict(const Rigid3d& cam_from_lidar,
                                         const Eigen::Vector3d& in_lidar) const override {
    const std::optional<Eigen::Vector2d> pixel = Project(camera_, cam_from_lidar * in_lidar);
    if (!pixel) return std::nullopt;
    return Eigen::Vector3d(pixel->x(), pixel->y(), 0.0);
  }

  void AddPosesOf(const Triple& cam, const Triple& lidar,
                  std::vector<Rigid3d>& poses) const override {
    std::array<Eigen::Vector3d, 3> rays;
    std::array<Eigen::Vector3d, 3> points;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!rays_[Slot(cam[i])]) return;
      rays[i] = *rays_[Slot(cam[i])];
      points[i] = in_lidar_[Slot(lidar[i])];
    }
    std::array<Rigid3d, kMaxP3pPoses> found;
    const int count = SolveP3p(rays, points, found);
    poses.insert(poses.end(), found.begin(), found.begin() + count);
  }

  std::optional<CorrespondenceFit> Fit(std::span<const Correspondence> correspondences,
                                       const Rigid3d& start) const override {
    std::vector<Pair2d3d> pairs;
    for (const Correspondence& c : correspondences) {
      pairs.push_back({.pixel = observed_[Slot(c.cam)].head<2>(),
                       .point_in_lidar = in_lidar_[Slot(c.lidar)],
                       .sigma_px = 1.0,
                       .id = {}});
    }
    PairTerms terms;
    terms.Add(pairs, camera_);
    const RefinedPose refined =
        RefinePose(terms.View(), start,
                   {.max_iterations = 30, .step_tolerance = 1e-8, .wants_information = false});
    if (refined.outcome == RefineOutcome::kNotProjected) return std::nullopt;
    return CorrespondenceFit{refined.cam_from_lidar, 2.0 * refined.cost};
  }

 private:
  Camera camera_;
  std::vector<std::optional<Eigen::Vector3d>> rays_;
};

}  // namespace

std::unique_ptr<CorrespondenceModel> ModelOf(std::span<const Pair3d3d> pairs) {
  return std::make_unique<PointModel>(pairs);
}

std::unique_ptr<CorrespondenceModel> ModelOf(std::span<const Pair2d3d> pairs,
                                             const Camera& camera) {
  return std::make_unique<PixelModel>(pairs, camera);
}

}  // namespace sextant
