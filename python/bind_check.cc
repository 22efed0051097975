// SPDX-License-Identifier: Apache-2.0
// check(): whether a pose is still valid, by images and scans of everyday scenes.
#include <fmt/core.h>
#include <pybind11/stl.h>

#include <opencv2/core.hpp>

#include "base/units.h"
#include "calibrate/scene/pose_check.h"
#include "features/camera/grey_image.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/raise.h"
#include "python/sensor_arrays.h"

namespace sextant::python {
namespace {

ScenePair ScenePairOf(const cv::Mat& image, const PointCloud& cloud, const Camera& camera,
                      const Rigid3d& pose) {
  cv::Mat grey = ValueOf(ToGrey(image));
  if (grey.depth() == CV_16U) grey.convertTo(grey, CV_8U, 1.0 / 257.0);
  if (grey.cols != camera.width_px || grey.rows != camera.height_px) {
    throw ErrorException({ErrorCode::kInvalidInput,
                          fmt::format("expected images of the camera's size, {} x {}; got {} x {}",
                                      camera.width_px, camera.height_px, grey.cols, grey.rows)});
  }
  return ValueOf(MakeScenePair(grey, cloud, camera, pose));
}

PoseCheck CheckArrays(const py::object& pose, const py::list& images, const py::list& clouds,
                      Camera camera, double detect_mm, double detect_deg) {
  if (images.size() != clouds.size() || images.empty()) {
    throw ErrorException({ErrorCode::kInvalidInput,
                          fmt::format("expected as many images as clouds, at least one; got {} and "
                                      "{}",
                                      images.size(), clouds.size())});
  }
  const Rigid3d given = PoseFrom(pose, "pose");
  std::vector<ScenePair> pairs;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const cv::Mat image = ImageFrom(images[i], fmt::format("images[{}]", i));
    const PointCloud cloud = CloudFrom(clouds[i], fmt::format("clouds[{}]", i));
    if (camera.width_px == 0) {
      camera.width_px = image.cols;
      camera.height_px = image.rows;
    }
    pairs.push_back(WithoutGil([&] { return ScenePairOf(image, cloud, camera, given); }));
  }
  const CheckLimits limits{.rotation_rad = kRadPerDeg * detect_deg,
                           .translation_m = 1e-3 * detect_mm};
  return WithoutGil([&] {
    const auto progress = [](std::string_view, std::size_t, std::size_t) { EndIfInterrupted(); };
    return CheckScenes(SearchScenes(pairs, given, progress), given, limits);
  });
}

// None where nothing is known, or the measured pose is beyond what the search measures.
py::object CheckSigma(const PoseCheck& check) {
  const Vector6d sigma = check.covariance.diagonal().cwiseSqrt();
  if (!sigma.allFinite() || !(sigma.minCoeff() > 0.0)) return py::none();
  return ArrayOf(std::span<const double>(sigma.data(), 6));
}

}  // namespace

void BindCheck(py::module_& module) {
  using C = PoseCheck;
  py::class_<C>(module, "PoseCheck", "What check() found.")
      .def_property_readonly(
          "state", [](const C& c) { return std::string(ToString(c.state)); },
          "\"still valid\", \"moved\" or \"cannot tell\".")
      .def_readonly("is_certain", &C::is_certain, "The pose has changed, by however little.")
      .def_readonly("reason", &C::reason, "Why, in one sentence.")
      .def_property_readonly(
          "change", [](const C& c) { return ArrayOf(std::span<const double>(c.change.data(), 6)); },
          "Measured minus given pose, (dphi [rad], dt [m]) in the axes of the camera, (6,).")
      .def_property_readonly("sigma", &CheckSigma, "1 sigma of the change, (6,), or None.")
      .def("__repr__",
           [](const C& c) { return fmt::format("{}: {}", ToString(c.state), c.reason); });
  module.def("check_arrays", &CheckArrays);
}

}  // namespace sextant::python
