// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/everyday_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/random.h"
#include "base/units.h"
#include "simulator/scene/scene_pose.h"

namespace sextant {
namespace {

// Objects with random surfaces.
class ScenePainter {
 public:
  ScenePainter(Scene& scene, Random& random) : scene_(scene), random_(random) {}

  double Between(double low, double high) { return random_.Uniform(low, high); }
  bool Happens(double probability) { return random_.Uniform() < probability; }

  // A box that stands on the floor at `base`, or above it.
  void Box(const Eigen::Vector3d& base, const Eigen::Vector3d& size, double yaw_rad) {
    const Rigid3d pose{SceneRotation(SceneAxes::kForwardIsX, {.yaw = yaw_rad}),
                       base + 0.5 * size.z() * Eigen::Vector3d::UnitZ()};
    scene_.boxes.push_back({.name = NameOf("box", scene_.boxes.size()),
                            .world_from_box = pose,
                            .size_m = size,
                            .surface = AnySurface()});
  }

  void Cylinder(const Eigen::Vector3d& base, double radius_m, double height_m) {
    scene_.cylinders.push_back({.name = NameOf("cylinder", scene_.cylinders.size()),
                                .base_in_world = base,
                                .radius_m = radius_m,
                                .height_m = height_m,
                                .surface = AnySurface()});
  }

  // A rectangle whose front looks against the direction of `yaw`; pitch 90 deg: a floor.
  void Wall(const Eigen::Vector3d& center, double width_m, double height_m, const EulerZyx& turn,
            double speckle_m = 0.0) {
    scene_.walls.push_back(
        {.name = NameOf("wall", scene_.walls.size()),
         .world_from_wall = {SceneRotation(SceneAxes::kForwardIsZ, turn), center},
         .width_m = width_m,
         .height_m = height_m,
         .surface = AnySurface(),
         .tile_m = speckle_m,
         .speckled = speckle_m > 0.0});
  }

  void Person(const Eigen::Vector3d& base) {
    const double radius = Between(0.18, 0.25);
    Cylinder(base, radius, Between(1.3, 1.5));
    Cylinder(base + Eigen::Vector3d(0.0, 0.0, 1.5), 0.11, 0.25);
  }

 private:
  static std::string NameOf(const char* what, std::size_t count) {
    return what + std::to_string(count);
  }

  Surface AnySurface() {
    Surface surface;
    surface.reflectivity = Between(0.1, 0.9);
    surface.albedo = Between(0.08, 0.9);
    return surface;
  }

  Scene& scene_;
  Random& random_;
};

constexpr double kQuarter_rad = 0.5 * std::numbers::pi;

// Pictures on a wall that faces the sensors, flat to a LiDAR.
void HangPictures(ScenePainter& painter, double x, double width_m, double height_m) {
  for (double y = -0.5 * width_m + 0.8; y < 0.5 * width_m - 0.8; y += painter.Between(1.0, 2.5)) {
    const double side = painter.Between(0.3, 0.9);
    painter.Wall({x - 0.02, y, 0.6 * height_m}, side, painter.Between(0.3, 0.7), {}, side / 4.0);
  }
}

void Furnish(ScenePainter& painter, double length_m, double width_m) {
  const int count = 6 + static_cast<int>(painter.Between(0.0, 6.0));
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d base{painter.Between(1.8, length_m - 0.8),
                               painter.Between(-0.5 * width_m + 0.5, 0.5 * width_m - 0.5), 0.0};
    const double yaw = painter.Between(-0.6, 0.6);
    const double kind = painter.Between(0.0, 4.0);
    if (kind < 1.0) {  // A table, with what stands on it.
      const double height = painter.Between(0.65, 0.8);
      const Eigen::Vector3d top(0.0, 0.0, height);
      painter.Box(base + top, {painter.Between(0.6, 1.0), painter.Between(0.8, 1.6), 0.04}, yaw);
      painter.Box(base, {0.08, 0.08, height}, yaw);
      const Eigen::Vector3d beside(0.0, painter.Between(-0.3, 0.3), 0.04);
      painter.Box(base + top + beside, {0.2, painter.Between(0.2, 0.5), painter.Between(0.2, 0.4)},
                  yaw + 0.3);
    } else if (kind < 2.0) {
      painter.Box(base, {0.5, painter.Between(0.5, 1.2), painter.Between(0.9, 2.0)}, yaw);
    } else if (kind < 3.0) {
      const double radius = painter.Between(0.08, 0.3);
      painter.Cylinder(base, radius, painter.Between(0.8, 2.4));
    } else {
      painter.Person(base);
    }
  }
}

void MakeRoom(ScenePainter& painter) {
  const double length = painter.Between(5.0, 11.0);
  const double width = painter.Between(6.0, 10.0);
  constexpr double kHeight_m = 2.8;
  constexpr double kBehind_m = 2.0;
  const double middle = 0.5 * (length - kBehind_m);
  const double depth = length + kBehind_m;
  painter.Wall({middle, 0.0, 0.0}, width, depth, {.pitch = kQuarter_rad}, 0.4);
  painter.Wall({middle, 0.0, kHeight_m}, width, depth, {.pitch = kQuarter_rad});
  painter.Wall({length, 0.0, 0.5 * kHeight_m}, width, kHeight_m, {});
  painter.Wall({-kBehind_m, 0.0, 0.5 * kHeight_m}, width, kHeight_m, {});
  for (const double side : {-0.5, 0.5}) {
    painter.Wall({middle, side * width, 0.5 * kHeight_m}, depth, kHeight_m, {.yaw = kQuarter_rad});
  }
  HangPictures(painter, length, width, kHeight_m);
  Furnish(painter, length, width);
}

// Houses along one side of the street, with windows that a LiDAR takes for the facade.
void BuildHouses(ScenePainter& painter, double side) {
  for (double x = -8.0; x < 60.0;) {
    const double length = painter.Between(7.0, 16.0);
    const double setback = painter.Between(8.0, 12.0);
    const double height = painter.Between(5.0, 14.0);
    const double depth = 8.0;
    painter.Box({x + 0.5 * length, side * (setback + 0.5 * depth), 0.0}, {length, depth, height},
                0.0);
    for (double along = 1.0; along < length - 1.5; along += painter.Between(2.0, 3.5)) {
      for (double up = 1.7; up < height - 1.0; up += 3.0) {
        painter.Wall({x + along + 0.6, side * (setback - 0.02), up}, 1.2, 1.5,
                     {.yaw = side * kQuarter_rad}, painter.Happens(0.3) ? 0.4 : 0.0);
      }
    }
    x += length + (painter.Happens(0.4) ? painter.Between(2.0, 5.0) : 0.0);
  }
}

void ParkVehicles(ScenePainter& painter, double side) {
  for (double x = painter.Between(4.0, 9.0); x < 50.0; x += painter.Between(6.0, 14.0)) {
    const Eigen::Vector3d base(x, side * painter.Between(3.6, 4.4), 0.25);
    const double yaw = painter.Between(-0.08, 0.08);
    if (painter.Happens(0.2)) {
      painter.Box(base, {5.5, 2.0, painter.Between(1.9, 2.4)}, yaw);
      continue;
    }
    painter.Box(base, {painter.Between(3.8, 4.6), 1.75, 0.65}, yaw);
    painter.Box(base + Eigen::Vector3d(0.2, 0.0, 0.65), {2.2, 1.5, 0.55}, yaw);
  }
}

// Trees, poles with signs, and persons on the pavement.
void FillPavement(ScenePainter& painter, double side) {
  for (double x = painter.Between(5.0, 10.0); x < 45.0; x += painter.Between(4.0, 9.0)) {
    const Eigen::Vector3d base(x, side * painter.Between(5.6, 7.4), 0.0);
    const double kind = painter.Between(0.0, 3.0);
    if (kind < 1.0) {
      const double radius = painter.Between(0.12, 0.3);
      painter.Cylinder(base, radius, painter.Between(2.5, 6.0));
    } else if (kind < 2.0) {
      const double height = painter.Between(2.2, 3.2);
      painter.Cylinder(base, 0.05, height);
      painter.Box(base + Eigen::Vector3d(-0.08, 0.0, height - 0.7),
                  {0.03, painter.Between(0.5, 0.9), 0.6}, 0.0);
    } else {
      painter.Person(base);
    }
  }
}

void MakeStreet(ScenePainter& painter) {
  painter.Wall({25.0, 0.0, 0.0}, 60.0, 80.0, {.pitch = kQuarter_rad});
  for (double x = 3.0; x < 50.0; x += 6.0) {
    painter.Wall({x, 0.3, 0.01}, 0.15, 3.0, {.pitch = kQuarter_rad});
  }
  for (const double side : {-1.0, 1.0}) {
    BuildHouses(painter, side);
    ParkVehicles(painter, side);
    FillPavement(painter, side);
  }
  if (painter.Happens(0.7)) {  // A vehicle ahead.
    const Eigen::Vector3d base{painter.Between(10.0, 30.0), painter.Between(-2.0, 1.5), 0.25};
    const double yaw = painter.Between(-0.1, 0.1);
    painter.Box(base, {4.2, 1.8, painter.Between(1.2, 2.2)}, yaw);
  }
}

SceneCamera CameraBeside(const Rigid3d& world_from_lidar, const Eigen::Vector3d& offset,
                         Random& random) {
  EulerZyx turn;
  turn.yaw = random.Uniform(-2.0, 2.0) * kRadPerDeg;
  turn.pitch = random.Uniform(-2.0, 2.0) * kRadPerDeg;
  turn.roll = random.Uniform(-2.0, 2.0) * kRadPerDeg;
  SceneCamera camera;
  camera.intrinsics = {.width_px = 1240,
                       .height_px = 376,
                       .fx_px = 720.0,
                       .fy_px = 720.0,
                       .cx_px = 619.5,
                       .cy_px = 187.5};
  camera.world_from_cam = {SceneRotation(SceneAxes::kForwardIsZ, turn),
                           world_from_lidar.translation + offset};
  return camera;
}

}  // namespace

std::optional<EverydayPlace> FindEverydayPlace(std::string_view name) {
  if (name == "room") return EverydayPlace::kRoom;
  if (name == "street") return EverydayPlace::kStreet;
  return std::nullopt;
}

Scene EverydayScene(EverydayPlace place, std::uint64_t seed) {
  Random random(DeriveSeed(seed, "everyday scene", static_cast<std::uint64_t>(place), 0));
  const bool is_street = place == EverydayPlace::kStreet;
  Scene scene;
  scene.name = is_street ? "street" : "room";
  ScenePainter painter(scene, random);
  if (is_street) {
    MakeStreet(painter);
  } else {
    MakeRoom(painter);
  }
  scene.lidar.model = is_street ? "hdl64e" : "vlp16";
  scene.lidar.world_from_lidar.translation.z() = is_street ? 1.73 : 0.9;
  // The pose between the sensors is that of a rig: the same for all seeds.
  Random rig(7);
  const Eigen::Vector3d offset =
      is_street ? Eigen::Vector3d(0.27, 0.0, -0.08) : Eigen::Vector3d(0.05, 0.06, -0.1);
  scene.cameras = {CameraBeside(scene.lidar.world_from_lidar, offset, rig)};
  return scene;
}

}  // namespace sextant
