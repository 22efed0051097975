// SPDX-License-Identifier: Apache-2.0
// sextant.Problem: arrays to a CalibrationProblem and back.
#include <fmt/core.h>
#include <pybind11/stl.h>

#include "eval/diagnostics/repeated_pairs.h"
#include "io/problems/problem_range.h"
#include "io/problems/read_problem.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/module_types.h"
#include "python/raise.h"

namespace sextant::python {
namespace {

void CheckSameLength(std::size_t lidar, std::size_t other, const char* name) {
  if (lidar == other) return;
  throw ErrorException({ErrorCode::kInvalidInput,
                        fmt::format("{}: expected one row for each of the {} LiDAR points, got {}",
                                    name, lidar, other)});
}

std::vector<Eigen::Vector3d> OptionalPoints(const py::object& object, const char* name) {
  return object.is_none() ? std::vector<Eigen::Vector3d>() : Points3From(object, name);
}

std::vector<PairId> IdsFrom(const py::object& views, const py::object& boards,
                            const py::object& corners, std::size_t count) {
  std::vector<PairId> ids(count);
  const auto read = [&](const py::object& object, const char* name, int PairId::*member) {
    if (object.is_none()) return;
    const std::vector<int> numbers = IntegersFrom(object, name, count);
    for (std::size_t i = 0; i < count; ++i) ids[i].*member = numbers[i];
  };
  read(views, "views", &PairId::view);
  read(boards, "boards", &PairId::board);
  read(corners, "corners", &PairId::corner);
  return ids;
}

void AddPointPairs(const std::vector<Eigen::Vector3d>& in_lidar, const py::object& object,
                   const py::object& sigma, const std::vector<PairId>& ids,
                   CalibrationProblem& problem) {
  const std::vector<Eigen::Vector3d> in_cam = Points3From(object, "points_in_cam");
  CheckSameLength(in_lidar.size(), in_cam.size(), "points_in_cam");
  const std::vector<double> sigmas = NumbersFrom(sigma, "sigma_m", in_cam.size());
  problem.pairs_3d3d.reserve(in_cam.size());
  for (std::size_t i = 0; i < in_cam.size(); ++i) {
    problem.pairs_3d3d.push_back({.point_in_cam = in_cam[i],
                                  .point_in_lidar = in_lidar[i],
                                  .sigma_m = sigmas[i],
                                  .covariance_in_cam = {},
                                  .id = ids[i]});
  }
}

void AddPixelPairs(const std::vector<Eigen::Vector3d>& in_lidar, const py::object& object,
                   const py::object& sigma, const std::vector<PairId>& ids,
                   CalibrationProblem& problem) {
  const std::vector<Eigen::Vector2d> pixels = Points2From(object, "pixels");
  CheckSameLength(in_lidar.size(), pixels.size(), "pixels");
  const std::vector<double> sigmas = NumbersFrom(sigma, "sigma_px", pixels.size());
  problem.pairs_2d3d.reserve(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    problem.pairs_2d3d.push_back(
        {.pixel = pixels[i], .point_in_lidar = in_lidar[i], .sigma_px = sigmas[i], .id = ids[i]});
  }
}

void Summarise(const CalibrationProblem& problem, ResultInput& input) {
  input.pairs_3d3d = static_cast<int>(problem.pairs_3d3d.size());
  input.pairs_2d3d = static_cast<int>(problem.pairs_2d3d.size());
  input.points_in_cam = static_cast<int>(problem.point_sets.in_cam.size());
  input.points_in_lidar = static_cast<int>(problem.point_sets.in_lidar.size());
}

ModuleProblem MakeProblem(const py::object& points_in_lidar, const py::object& points_in_cam,
                          const py::object& pixels, const py::object& sigma_m,
                          const py::object& sigma_px, const std::optional<Camera>& camera,
                          const py::object& initial, const py::object& views,
                          const py::object& boards, const py::object& corners,
                          const py::object& set_in_lidar, const py::object& set_in_cam) {
  auto problem = std::make_shared<CalibrationProblem>();
  const std::vector<Eigen::Vector3d> in_lidar = OptionalPoints(points_in_lidar, "points_in_lidar");
  const std::vector<PairId> ids = IdsFrom(views, boards, corners, in_lidar.size());
  if (!points_in_cam.is_none()) AddPointPairs(in_lidar, points_in_cam, sigma_m, ids, *problem);
  if (!pixels.is_none()) AddPixelPairs(in_lidar, pixels, sigma_px, ids, *problem);
  problem->point_sets = {.in_cam = OptionalPoints(set_in_cam, "set_in_cam"),
                         .in_lidar = OptionalPoints(set_in_lidar, "set_in_lidar")};
  if (problem->point_sets.in_cam.empty() && problem->point_sets.in_lidar.empty()) {
    problem->point_sets = WithholdPairing(problem->pairs_3d3d);
  }
  problem->camera = camera;
  if (!initial.is_none()) problem->initial_cam_from_lidar = PoseFrom(initial, "initial");
  ModuleProblem made{.data = problem};
  made.input.format = "arrays";
  Summarise(*problem, made.input);
  return made;
}

ModuleProblem ReadProblemFile(const std::string& path, const std::optional<Camera>& camera) {
  return WithoutGil([&] {
    const DetectedProblem read = ValueOf(ReadProblem(path));
    auto problem = std::make_shared<CalibrationProblem>(read.problem);
    if (camera) problem->camera = camera;
    ModuleProblem made{.data = problem,
                       .true_cam_from_lidar = read.true_cam_from_lidar,
                       .input = {.path = path, .format = std::string(ToString(read.format))},
                       .notes = read.notes};
    for (const RepeatedPairs& repeated : MergeRepeatedPairs(*problem)) {
      for (std::string& line : Describe(repeated)) made.notes.push_back(std::move(line));
    }
    Summarise(*problem, made.input);
    return made;
  });
}

// One array of a member of every pair.
template <class Pair, class Value>
std::vector<Value> Column(const std::vector<Pair>& pairs, Value Pair::*member) {
  std::vector<Value> column;
  column.reserve(pairs.size());
  for (const Pair& pair : pairs) column.push_back(pair.*member);
  return column;
}

template <class Pair, class Value>
auto ColumnOf(std::vector<Pair> CalibrationProblem::*pairs, Value Pair::*member) {
  return [pairs, member](const ModuleProblem& p) {
    const std::vector<Value> column = Column((*p.data).*pairs, member);
    return ArrayOf(std::span<const Value>(column));
  };
}

// Boards, views and corners of the 3D-3D pairs, or of the 2D-3D ones where there are no others.
auto IdsOf(int PairId::*member) {
  return [member](const ModuleProblem& p) {
    std::vector<int> ids;
    for (const Pair3d3d& pair : p.data->pairs_3d3d) ids.push_back(pair.id.*member);
    if (ids.empty()) {
      for (const Pair2d3d& pair : p.data->pairs_2d3d) ids.push_back(pair.id.*member);
    }
    return ArrayOf(std::span<const int>(ids));
  };
}

py::object OptionalPose(const std::optional<Rigid3d>& pose) {
  return pose ? py::object(PoseArray(*pose)) : py::object(py::none());
}

std::string ProblemRepr(const ModuleProblem& problem) {
  const std::string path =
      problem.input.path.empty() ? std::string() : fmt::format("'{}', ", problem.input.path);
  return fmt::format("<sextant.Problem {}{} 3D-3D pairs, {} 2D-3D pairs{}>", path,
                     problem.input.pairs_3d3d, problem.input.pairs_2d3d,
                     problem.data->camera ? ", with a camera" : "");
}

void BindPairs(py::class_<ModuleProblem>& problem) {
  using P = CalibrationProblem;
  problem
      .def_property_readonly("points_in_lidar", ColumnOf(&P::pairs_3d3d, &Pair3d3d::point_in_lidar),
                             "LiDAR points of the 3D-3D pairs, (N, 3) [m].")
      .def_property_readonly("points_in_cam", ColumnOf(&P::pairs_3d3d, &Pair3d3d::point_in_cam),
                             "Camera points of the 3D-3D pairs, (N, 3) [m].")
      .def_property_readonly("sigma_m", ColumnOf(&P::pairs_3d3d, &Pair3d3d::sigma_m),
                             "1 sigma per axis of their difference, (N,) [m]; 0: unknown.")
      .def_property_readonly("pixels", ColumnOf(&P::pairs_2d3d, &Pair2d3d::pixel),
                             "Pixels of the 2D-3D pairs, (M, 2).")
      .def_property_readonly("pixel_points_in_lidar",
                             ColumnOf(&P::pairs_2d3d, &Pair2d3d::point_in_lidar),
                             "LiDAR points of the 2D-3D pairs, (M, 3) [m].")
      .def_property_readonly("sigma_px", ColumnOf(&P::pairs_2d3d, &Pair2d3d::sigma_px),
                             "1 sigma per axis of the pixels, (M,); 0: unknown.")
      .def_property_readonly("views", IdsOf(&PairId::view), "Number of each pair's view, (N,).")
      .def_property_readonly("boards", IdsOf(&PairId::board), "Id of each pair's board, (N,).")
      .def_property_readonly("corners", IdsOf(&PairId::corner), "Number of each corner, (N,).");
}

}  // namespace

void BindProblem(py::module_& module) {
  py::class_<ModuleProblem> problem(
      module, "Problem",
      "What a solver may use. Every array is a copy, made at each access.\n\n"
      "points_in_lidar (N, 3) with points_in_cam (N, 3), pixels (N, 2), or both; metres. sigma_m\n"
      "and sigma_px: 1 sigma per axis, a number or (N,); 0 where unknown, for all pairs or none.\n"
      "views, boards, corners: (N,) integers. initial: cam_from_lidar (4, 4). set_in_lidar and\n"
      "set_in_cam: points whose pairing is unknown; by default those of the pairs.");
  problem.def(py::init(&MakeProblem), py::arg("points_in_lidar") = py::none(),
              py::arg("points_in_cam") = py::none(), py::kw_only(), py::arg("pixels") = py::none(),
              py::arg("sigma_m") = 0.0, py::arg("sigma_px") = 0.0, py::arg("camera") = std::nullopt,
              py::arg("initial") = py::none(), py::arg("views") = py::none(),
              py::arg("boards") = py::none(), py::arg("corners") = py::none(),
              py::arg("set_in_lidar") = py::none(), py::arg("set_in_cam") = py::none());
  problem.def_static("read", &ReadProblemFile, py::arg("path"), py::arg("camera") = std::nullopt,
                     "Reads correspondences in any format of `sextant solve`; pairs that occur\n"
                     "twice are merged as there.");
  BindPairs(problem);
  problem
      .def_property_readonly(
          "set_in_lidar",
          [](const ModuleProblem& p) { return ArrayOf(p.data->point_sets.in_lidar); })
      .def_property_readonly(
          "set_in_cam", [](const ModuleProblem& p) { return ArrayOf(p.data->point_sets.in_cam); })
      .def_property_readonly("camera", [](const ModuleProblem& p) { return p.data->camera; })
      .def_property_readonly(
          "initial",
          [](const ModuleProblem& p) { return OptionalPose(p.data->initial_cam_from_lidar); })
      .def_property_readonly(
          "true_matrix", [](const ModuleProblem& p) { return OptionalPose(p.true_cam_from_lidar); },
          "The true cam_from_lidar (4, 4) of simulated data; never part of what a solver gets.")
      .def_readonly("notes", &ModuleProblem::notes)
      .def("__repr__", &ProblemRepr);
}

}  // namespace sextant::python
