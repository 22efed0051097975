// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/term_scorer.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "solvers/kernels/kabsch_fit.h"
#include "solvers/kernels/pixel_sums.h"
#include "solvers/robust/pair_statistics.h"

namespace sextant {
namespace {

constexpr double kNotProjected = std::numeric_limits<double>::infinity();

}  // namespace

TermScorer::TermScorer(PairTerms terms)
    : PairScorer(terms.pixels.empty() ? PairKind::k3d3d : PairKind::k2d3d, terms.size()),
      terms_(std::move(terms)) {
  inliers_.reserve(size());
  inlier_terms_.points.reserve(terms_.points.size());
  inlier_terms_.pixels.reserve(terms_.pixels.size());
}

// Calls visit(r_i^2) in order until it returns false.
template <class Visit>
void TermScorer::ForEach(const Rigid3d& pose, Visit&& visit) const {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  const Eigen::Vector3d& t = pose.translation;
  for (const PointTerm& term : terms_.points) {
    const Eigen::Vector3d residual = term.in_cam - (r * term.in_lidar + t);
    if (!visit((term.whitener * residual).squaredNorm())) return;
  }
  const Camera& camera = terms_.camera;
  if (camera.model == CameraModel::kPinhole) {
    const PinholePose pinhole(camera, pose);
    std::size_t left = terms_.pixels.size();
    for (const PixelBlock& block : terms_.pixels.blocks()) {
      double squared[kSimdWidth];
      SquarePixels(std::span(&block, 1), pinhole, squared);
      for (std::size_t k = 0; k < std::min(left, kSimdWidth); ++k) {
        if (!visit(squared[k])) return;
      }
      left -= std::min(left, kSimdWidth);
    }
    return;
  }
  for (const PixelTerm term : terms_.pixels) {
    const std::optional<Eigen::Vector2d> projected = Project(camera, r * term.in_lidar + t);
    const double squared = projected ? (term.pixel - *projected).squaredNorm() *
                                           term.inverse_sigma * term.inverse_sigma
                                     : kNotProjected;
    if (!visit(squared)) return;
  }
}

double TermScorer::CostUpTo(const Rigid3d& pose, double max_squared, double give_up) const {
  if (terms_.points.empty() && terms_.camera.model == CameraModel::kPinhole) {
    return TruncatedPixelCost(terms_.pixels.blocks(), PinholePose(terms_.camera, pose), max_squared,
                              give_up);
  }
  double cost = 0.0;
  ForEach(pose, [&](double squared) {
    // A residual that is not a number counts as an outlier's.
    cost += squared < max_squared ? squared : max_squared;
    return cost < give_up;
  });
  return cost;
}

void TermScorer::SquaredResiduals(const Rigid3d& pose, std::span<double> squared) const {
  std::size_t i = 0;
  ForEach(pose, [&](double value) {
    squared[i++] = value;
    return true;
  });
}

void TermScorer::Inliers(const Rigid3d& pose, double max_squared, std::vector<int>& inliers) const {
  inliers.clear();
  int i = 0;
  ForEach(pose, [&](double squared) {
    if (squared <= max_squared) inliers.push_back(i);
    ++i;
    return true;
  });
}

// The closed form, where the noise of every inlier is isotropic and the points determine a pose.
std::optional<Rigid3d> TermScorer::FitIsotropicInliers() {
  in_cam_.clear();
  in_lidar_.clear();
  inverse_variances_.clear();
  for (const PointTerm& term : inlier_terms_.points) {
    const double inverse_sigma = term.whitener(0, 0);
    if (term.whitener != inverse_sigma * Eigen::Matrix3d::Identity()) return std::nullopt;
    in_cam_.push_back(term.in_cam);
    in_lidar_.push_back(term.in_lidar);
    inverse_variances_.push_back(inverse_sigma * inverse_sigma);
  }
  const KabschOutcome fit = FitPoints(in_cam_, in_lidar_, inverse_variances_);
  if (!fit) return std::nullopt;
  return fit->b_from_a;
}

std::optional<Rigid3d> TermScorer::FitInliers(const Rigid3d& pose, double max_squared,
                                              const RefineLimits& limits) {
  const std::size_t min_pairs = kind() == PairKind::k3d3d ? 3 : 4;
  Inliers(pose, max_squared, inliers_);
  if (inliers_.size() < min_pairs) return std::nullopt;
  inlier_terms_.AssignSubset(terms_, inliers_);
  if (kind() == PairKind::k3d3d) {
    if (std::optional<Rigid3d> closed_form = FitIsotropicInliers()) return closed_form;
  }
  RefineLimits of_pose = limits;
  of_pose.wants_information = false;
  return RefinePose(inlier_terms_.View(), pose, of_pose).cam_from_lidar;
}

double TermScorer::RandomAgreementProbability(double max_squared) const {
  const double threshold = std::sqrt(max_squared);
  if (kind() == PairKind::k3d3d) {
    Eigen::AlignedBox3d box;
    double radius = 0.0;
    for (const PointTerm& term : terms_.points) {
      box.extend(term.in_cam);
      radius += threshold / std::cbrt(std::abs(term.whitener.determinant()));
    }
    radius /= static_cast<double>(size());
    return RandomPointProbability(box, radius);
  }
  Eigen::AlignedBox2d box;
  double radius = 0.0;
  for (const PixelTerm term : terms_.pixels) {
    box.extend(term.pixel);
    radius += threshold / term.inverse_sigma;
  }
  radius /= static_cast<double>(size());
  return RandomPointProbability(box, radius);
}

int TermScorer::CountDistinct(std::span<const int> indices) const {
  return CountDistinctPairs(indices, [this](std::size_t i) {
    if (kind() == PairKind::k3d3d) {
      const Eigen::Vector3d& c = terms_.points[i].in_cam;
      const Eigen::Vector3d& l = terms_.points[i].in_lidar;
      return PairNumbers{c.x(), c.y(), c.z(), l.x(), l.y(), l.z()};
    }
    const PixelTerm term = terms_.pixels[i];
    const Eigen::Vector3d& l = term.in_lidar;
    return PairNumbers{term.pixel.x(), term.pixel.y(), 1.0, l.x(), l.y(), l.z()};
  });
}

PairTerms TermScorer::Terms(std::span<const int> indices) const {
  PairTerms terms;
  terms.AssignSubset(terms_, indices);
  return terms;
}

BitGraph TermScorer::AgreementGraph(double max_squared) const {
  const std::vector<PointTerm>& terms = terms_.points;
  std::vector<Eigen::Matrix3d> noise;
  noise.reserve(terms.size());
  for (const PointTerm& term : terms) {
    const Eigen::Matrix3d factor = term.whitener.inverse();
    noise.emplace_back(factor * factor.transpose());
  }
  BitGraph graph(static_cast<int>(terms.size()));
  for (std::size_t i = 0; i < terms.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector3d in_cam = terms[i].in_cam - terms[j].in_cam;
      const double lidar_length = (terms[i].in_lidar - terms[j].in_lidar).norm();
      const double cam_squared = in_cam.squaredNorm();
      const double excess = std::sqrt(cam_squared) - lidar_length;
      // excess^2 <= max_squared u^T S u with u = c / |c|, without the division by |c|^2.
      const double spread = in_cam.dot((noise[i] + noise[j]) * in_cam);
      if (excess * excess * cam_squared <= max_squared * spread) {
        graph.Connect(static_cast<int>(i), static_cast<int>(j));
      }
    }
  }
  return graph;
}

double TermScorer::LargestSquared(const Rigid3d& pose) const {
  double largest = 0.0;
  ForEach(pose, [&](double squared) {
    if (std::isfinite(squared)) largest = std::max(largest, squared);
    return true;
  });
  return largest;
}

GncReweighting TermScorer::Reweight(const Rigid3d& pose, const GncWeight& weight_of) {
  if (weights_.empty()) weights_.assign(size(), 1.0);
  GncReweighting result;
  std::size_t i = 0;
  ForEach(pose, [&](double squared) {
    const double weight = weight_of.At(squared);
    result.unsettled = std::max(
        {result.unsettled, std::min(weight, 1.0 - weight), std::abs(weight - weights_[i])});
    weights_[i++] = weight;
    return true;
  });
  return result;
}

}  // namespace sextant
