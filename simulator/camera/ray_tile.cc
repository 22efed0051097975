// SPDX-License-Identifier: Apache-2.0
#include "simulator/camera/ray_tile.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr int kNodes = 8;

using Weights = std::array<std::array<double, kNodes>, RayTile::kCorners>;

// Lagrange weights of the nodes for each corner along a side; nodes and corners both span [0,
// kPixels].
Weights LagrangeWeights() {
  constexpr double kSpacing = static_cast<double>(RayTile::kPixels) / (kNodes - 1);
  Weights weights;
  for (std::size_t corner = 0; corner < weights.size(); ++corner) {
    const double at = static_cast<double>(corner) / kSpacing;
    for (int i = 0; i < kNodes; ++i) {
      double product = 1.0;
      for (int j = 0; j < kNodes; ++j) {
        if (j != i) product *= (at - j) / (i - j);
      }
      weights[corner][static_cast<std::size_t>(i)] = product;
    }
  }
  return weights;
}

}  // namespace

RayTile::RayTile(const Camera& camera, int left, int top)
    : rays_(kCorners * kCorners), has_ray_(kCorners * kCorners, true) {
  const double first_x = left - 0.5;
  const double first_y = top - 0.5;
  if (!Interpolate(camera, first_x, first_y)) UnprojectAll(camera, first_x, first_y);
  FindCone();
}

bool RayTile::Interpolate(const Camera& camera, double left, double top) {
  static const Weights weights = LagrangeWeights();
  constexpr double kSpacing = static_cast<double>(kPixels) / (kNodes - 1);
  std::array<std::array<Eigen::Vector3d, kNodes>, kNodes> nodes;
  for (std::size_t row = 0; row < kNodes; ++row) {
    for (std::size_t column = 0; column < kNodes; ++column) {
      const std::optional<Eigen::Vector3d> ray =
          Unproject(camera, {left + kSpacing * static_cast<double>(column),
                             top + kSpacing * static_cast<double>(row)});
      if (!ray) return false;
      nodes[row][column] = *ray;
    }
  }
  for (std::size_t row = 0; row < kCorners; ++row) {
    std::array<Eigen::Vector3d, kNodes> across;
    for (std::size_t column = 0; column < kNodes; ++column) {
      across[column].setZero();
      for (std::size_t i = 0; i < kNodes; ++i) {
        across[column] += weights[row][i] * nodes[i][column];
      }
    }
    for (std::size_t column = 0; column < kCorners; ++column) {
      Eigen::Vector3d ray = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < kNodes; ++i) ray += weights[column][i] * across[i];
      rays_[row * kCorners + column] = ray;
    }
  }
  return true;
}

void RayTile::UnprojectAll(const Camera& camera, double left, double top) {
  for (int row = 0; row < kCorners; ++row) {
    for (int column = 0; column < kCorners; ++column) {
      const std::optional<Eigen::Vector3d> ray = Unproject(camera, {left + column, top + row});
      has_ray_[Index(row, column)] = ray.has_value();
      rays_[Index(row, column)] = ray.value_or(Eigen::Vector3d::Zero());
    }
  }
}

void RayTile::FindCone() {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& ray : rays_) sum += ray;
  any_ray_ = sum.squaredNorm() > 0.0;
  if (!any_ray_) return;
  axis_ = sum.normalized();
  double least_cosine = 1.0;
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    if (has_ray_[i]) least_cosine = std::min(least_cosine, axis_.dot(rays_[i]));
  }
  half_angle_rad_ = std::acos(least_cosine);
}

}  // namespace sextant
