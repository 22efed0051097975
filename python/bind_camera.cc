// SPDX-License-Identifier: Apache-2.0
// sextant.Camera: intrinsics, projection and rays.
#include <fmt/core.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <limits>

#include "geometry/camera.h"
#include "io/cameras/camera_file.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/raise.h"

namespace sextant::python {
namespace {

constexpr std::pair<const char*, CameraModel> kModels[] = {
    {"pinhole", CameraModel::kPinhole},
    {"brown_conrady", CameraModel::kBrownConrady},
    {"equidistant", CameraModel::kEquidistant},
    {"omnidirectional", CameraModel::kOmnidirectional},
    {"double_sphere", CameraModel::kDoubleSphere}};

CameraModel ModelOf(const std::string& name) {
  std::string known;
  for (const auto& [text, model] : kModels) {
    if (name == text) return model;
    known += known.empty() ? text : std::string(", ") + text;
  }
  throw ErrorException(
      {ErrorCode::kUnknownName, fmt::format("unknown camera model '{}'; known: {}", name, known)});
}

const char* NameOf(CameraModel model) {
  return std::ranges::find(kModels, model, &std::pair<const char*, CameraModel>::second)->first;
}

Camera MakeCamera(double fx, double fy, double cx, double cy, int width, int height,
                  const std::string& model, const std::vector<double>& distortion, double skew,
                  double xi, double alpha) {
  Camera camera{.width_px = width,
                .height_px = height,
                .fx_px = fx,
                .fy_px = fy,
                .cx_px = cx,
                .cy_px = cy,
                .skew_px = skew,
                .xi = xi,
                .alpha = alpha};
  if (distortion.size() > kMaxDistortion) {
    throw ErrorException({ErrorCode::kInvalidInput,
                          fmt::format("distortion: expected at most {} coefficients, got {}",
                                      kMaxDistortion, distortion.size())});
  }
  std::ranges::copy(distortion, camera.distortion.begin());
  const bool is_plain = std::ranges::all_of(distortion, [](double k) { return k == 0.0; });
  camera.model = !model.empty() ? ModelOf(model)
                 : is_plain     ? CameraModel::kPinhole
                                : CameraModel::kBrownConrady;
  ValueOf(ValidateCamera(camera));
  return camera;
}

py::array_t<double> ProjectPoints(const Camera& camera, const py::object& object) {
  const std::vector<Eigen::Vector3d> points = Points3From(object, "points_in_cam");
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<Eigen::Vector2d> pixels(points.size(), {kNone, kNone});
  WithoutGil([&] {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (const auto pixel = Project(camera, points[i])) pixels[i] = *pixel;
    }
  });
  return ArrayOf(pixels);
}

py::array_t<double> UnprojectPixels(const Camera& camera, const py::object& object) {
  const std::vector<Eigen::Vector2d> pixels = Points2From(object, "pixels");
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<Eigen::Vector3d> rays(pixels.size(), {kNone, kNone, kNone});
  WithoutGil([&] {
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (const auto ray = Unproject(camera, pixels[i])) rays[i] = *ray;
    }
  });
  return ArrayOf(rays);
}

Eigen::Matrix3d IntrinsicMatrix(const Camera& camera) {
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  k.topLeftCorner<2, 2>() = PixelByImage(camera);
  k.topRightCorner<2, 1>() << camera.cx_px, camera.cy_px;
  return k;
}

std::string ReprOf(const Camera& camera) {
  return fmt::format("Camera(fx={}, fy={}, cx={}, cy={}, width={}, height={}, model='{}')",
                     camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px, camera.width_px,
                     camera.height_px, NameOf(camera.model));
}

}  // namespace

void BindCamera(py::module_& module) {
  module.def("check_pose",
             [](const py::object& pose, const std::string& name) { PoseFrom(pose, name.c_str()); });
  py::class_<Camera>(module, "Camera",
                     "Intrinsics in pixels; pixel (0, 0) is the centre of the top-left pixel.\n\n"
                     "Camera frame: x right, y down, z forward. model: pinhole, brown_conrady,\n"
                     "equidistant, omnidirectional or double_sphere; by default brown_conrady if\n"
                     "there is a distortion (k1 k2 p1 p2 k3 ... as in OpenCV), else pinhole.")
      .def(py::init(&MakeCamera), py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"),
           py::kw_only(), py::arg("width") = 0, py::arg("height") = 0, py::arg("model") = "",
           py::arg("distortion") = std::vector<double>(), py::arg("skew") = 0.0,
           py::arg("xi") = 0.0, py::arg("alpha") = 0.0)
      .def_static(
          "read", [](const std::string& path) { return ValueOf(ReadCamera(path)); },
          py::arg("path"), "Reads any of the camera files that the program reads.")
      .def("project", &ProjectPoints, py::arg("points_in_cam"),
           "Pixels (N, 2) of points (N, 3) [m] in the camera frame; NaN where there is none.")
      .def("unproject", &UnprojectPixels, py::arg("pixels"),
           "Unit rays (N, 3) in the camera frame through pixels (N, 2); NaN where there is none.")
      .def_property_readonly(
          "matrix", [](const Camera& c) { return MatrixArray(IntrinsicMatrix(c)); }, "K, (3, 3).")
      .def_property_readonly("distortion",
                             [](const Camera& c) { return ArrayOf(std::span(c.distortion)); })
      .def_property_readonly("model", [](const Camera& c) { return NameOf(c.model); })
      .def_readonly("width", &Camera::width_px)
      .def_readonly("height", &Camera::height_px)
      .def("__repr__", &ReprOf);
}

}  // namespace sextant::python
