// SPDX-License-Identifier: Apache-2.0
#include "simulator/camera/area_sampler.h"

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <vector>

#include "simulator/camera/ray_tile.h"
#include "simulator/camera/straight_edge.h"

namespace sextant {
namespace {

constexpr int kTile = RayTile::kPixels - 2;

// `count` points in the unit square, each in the middle of its own row and column strip. Requires
// two successive Fibonacci numbers.
std::vector<Eigen::Vector2d> FibonacciLattice(int count, int number_before) {
  std::vector<Eigen::Vector2d> lattice;
  for (int i = 0; i < count; ++i) {
    lattice.push_back(Eigen::Vector2d(i + 0.5, i * number_before % count + 0.5) / count);
  }
  return lattice;
}

// The rays of a pixel, interpolated bilinearly between its corners: distortion is linear within a
// pixel.
struct PixelRays {
  Eigen::Vector3d origin;
  Eigen::Vector3d right;
  Eigen::Vector3d down;
  Eigen::Vector3d twist;

  Eigen::Vector3d At(const Eigen::Vector2d& at) const {
    return origin + at.x() * right + at.y() * down + at.x() * at.y() * twist;
  }
  PixelRays Mapped(const Eigen::Matrix3d& map) const {
    return {map * origin, map * right, map * down, map * twist};
  }
};

// One block of the image with a border of one pixel around it.
class Block {
 public:
  Block(const Camera& camera, const CameraView& view, int left, int top)
      : view_(view), tile_(camera, left - 1, top - 1) {
    if (!tile_.any_ray()) return;
    view.FindCandidates(tile_.axis(), tile_.half_angle_rad(), candidates_);
    // About twice the diagonal of a pixel.
    const double sliver_rad = 4.0 * tile_.half_angle_rad() / RayTile::kPixels;
    has_sliver_ = view.HasSliver(candidates_, sliver_rad);
    seen_.resize(RayTile::kCorners * RayTile::kCorners);
    for (int row = 0; row < RayTile::kCorners; ++row) {
      for (int column = 0; column < RayTile::kCorners; ++column) {
        if (tile_.HasRay(row, column))
          At(row, column) = view.Cast(tile_.Ray(row, column), candidates_);
      }
    }
    has_layers_.resize(RayTile::kPixels * RayTile::kPixels);
    for (int row = 0; row < RayTile::kPixels; ++row) {
      for (int column = 0; column < RayTile::kPixels; ++column) {
        has_layers_[LayerIndex(row, column)] = HasLayers(row, column);
      }
    }
  }

  // Mean radiance of the pixel in the block's row and column, both from 0.
  double Mean(int row, int column) {
    ++row;
    ++column;
    if (!IsWhole(row, column)) return 0.0;
    const std::array<double, 4> corners = {
        At(row, column).patch.radiance, At(row, column + 1).patch.radiance,
        At(row + 1, column + 1).patch.radiance, At(row + 1, column).patch.radiance};
    if (!has_sliver_ && IsOnePatch(row, column) && !IsNearLayers(row, column)) {
      return MeanOf(corners);
    }
    FindSurfacesAround(row, column);
    const PixelRays rays = RaysOf(row, column);
    const ViewRectangle* only = around_.size() == 1 ? view_.RectangleOf(around_[0]) : nullptr;
    if (only == nullptr) {
      return MeanOf(corners, [&](const Eigen::Vector2d& at) {
        return view_.Cast(rays.At(at), around_).patch.radiance;
      });
    }
    // Most often there is one face, whose map of rays is linear, too.
    const PixelRays on_face = rays.Mapped(only->plane_from_ray);
    return MeanOf(corners, [&](const Eigen::Vector2d& at) {
      const std::optional<ViewHit> hit = only->HitAt(on_face.At(at));
      return hit ? only->PatchAt(*hit).radiance : view_.background();
    });
  }

 private:
  static double MeanOf(const std::array<double, 4>& corners) {
    return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  }

  // Mean over the pixel of a radiance that is not the same everywhere.
  template <class RadianceAt>
  double MeanOf(const std::array<double, 4>& corners, const RadianceAt& radiance_at) {
    static const std::vector<Eigen::Vector2d> coarse = FibonacciLattice(55, 34);
    static const std::vector<Eigen::Vector2d> fine = FibonacciLattice(377, 233);
    const auto is_first = [&](double radiance) { return SameRadiance(radiance, corners[0]); };
    if (std::ranges::all_of(corners, is_first)) {
      if (std::ranges::all_of(coarse, is_first, radiance_at)) return MeanOf(corners);
    } else if (const auto mean = MeanAcrossStraightEdge(corners, coarse, radiance_at)) {
      return *mean;
    }
    double sum = 0.0;
    for (const Eigen::Vector2d& at : fine) sum += radiance_at(at);
    return sum / static_cast<double>(fine.size());
  }

  static std::size_t LayerIndex(int row, int column) {
    return static_cast<std::size_t>(row * RayTile::kPixels + column);
  }
  const Seen& At(int row, int column) const {
    return seen_[static_cast<std::size_t>(row * RayTile::kCorners + column)];
  }
  Seen& At(int row, int column) {
    return seen_[static_cast<std::size_t>(row * RayTile::kCorners + column)];
  }

  // Whether all corners of the pixel have rays.
  bool IsWhole(int row, int column) const {
    return tile_.any_ray() && tile_.HasRay(row, column) && tile_.HasRay(row, column + 1) &&
           tile_.HasRay(row + 1, column) && tile_.HasRay(row + 1, column + 1);
  }

  bool HasLayers(int row, int column) const {
    const Seen& first = At(row, column);
    return !first.SameLayer(At(row, column + 1)) || !first.SameLayer(At(row + 1, column)) ||
           !first.SameLayer(At(row + 1, column + 1));
  }

  // A corner of another layer may lie in a pixel although none of the pixel's corners is in that
  // layer; then one of its neighbours contains both layers.
  bool IsNearLayers(int row, int column) const {
    for (int y = row - 1; y <= row + 1; ++y) {
      for (int x = column - 1; x <= column + 1; ++x) {
        if (has_layers_[LayerIndex(y, x)]) return true;
      }
    }
    return false;
  }

  bool IsOnePatch(int row, int column) const {
    const Seen& first = At(row, column);
    return first.SamePatch(At(row, column + 1)) && first.SamePatch(At(row + 1, column)) &&
           first.SamePatch(At(row + 1, column + 1));
  }

  // Surfaces seen by the corners of the pixel and of its neighbours; all candidates if one is so
  // narrow that it may lie between the corners.
  void FindSurfacesAround(int row, int column) {
    if (has_sliver_) {
      around_ = candidates_;
      return;
    }
    around_.clear();
    for (int y = row - 1; y <= row + 2; ++y) {
      for (int x = column - 1; x <= column + 2; ++x) {
        const int surface = At(y, x).surface;
        if (surface >= 0 && std::ranges::count(around_, surface) == 0) around_.push_back(surface);
      }
    }
    std::ranges::sort(around_);
  }

  PixelRays RaysOf(int row, int column) const {
    const Eigen::Vector3d& origin = tile_.Ray(row, column);
    const Eigen::Vector3d right = tile_.Ray(row, column + 1) - origin;
    const Eigen::Vector3d down = tile_.Ray(row + 1, column) - origin;
    return {origin, right, down, tile_.Ray(row + 1, column + 1) - origin - right - down};
  }

  const CameraView& view_;
  RayTile tile_;
  std::vector<int> candidates_;
  bool has_sliver_ = false;
  std::vector<int> around_;
  std::vector<Seen> seen_;
  std::vector<bool> has_layers_;
};

}  // namespace

cv::Mat SampleAreas(const Camera& camera, const CameraView& view) {
  cv::Mat radiance(camera.height_px, camera.width_px, CV_32F);
  const auto blocks = [](int pixels) { return (pixels + kTile - 1) / kTile; };
  const tbb::blocked_range2d<int> all(0, blocks(camera.height_px), 0, blocks(camera.width_px));
  tbb::parallel_for(all, [&](const tbb::blocked_range2d<int>& range) {
    for (int y = range.rows().begin(); y < range.rows().end(); ++y) {
      for (int x = range.cols().begin(); x < range.cols().end(); ++x) {
        Block block(camera, view, x * kTile, y * kTile);
        const int height = std::min(kTile, camera.height_px - y * kTile);
        const int width = std::min(kTile, camera.width_px - x * kTile);
        for (int row = 0; row < height; ++row) {
          float* out = radiance.ptr<float>(y * kTile + row) + x * kTile;
          for (int column = 0; column < width; ++column) {
            out[column] = static_cast<float>(block.Mean(row, column));
          }
        }
      }
    }
  });
  return radiance;
}

}  // namespace sextant
