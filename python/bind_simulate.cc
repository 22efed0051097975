// SPDX-License-Identifier: Apache-2.0
// Sessions: simulated ones, and what the files of one are.
#include <pybind11/stl.h>

#include "calibrate/session/session.h"
#include "io/images/image_codec.h"
#include "io/text/text_file.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/raise.h"
#include "simulator/scene/scene_file.h"
#include "simulator/session/session.h"

namespace sextant::python {
namespace {

void Simulate(const std::string& scene_path, const std::string& out, int scans, std::uint64_t seed,
              const std::string& level, double interval_s, bool ideal) {
  SessionOptions options;
  options.folder = out;
  options.level = ValueOf(FindSessionLevel(level));
  options.seed = seed;
  options.scans = scans;
  options.interval_s = interval_s;
  options.ideal = ideal;
  options.encode_image = [](const cv::Mat& image) { return EncodeImage(".png", image); };
  WithoutGil([&] {
    const std::string text = ValueOf(ReadTextFile(scene_path));
    const Scene scene = ValueOf(ParseScene(text, scene_path));
    ValueOf(SimulateSession(scene, text, options));
  });
}

py::object OptionalMatrix(const std::optional<Rigid3d>& pose) {
  return pose ? py::object(PoseArray(*pose)) : py::object(py::none());
}

py::list PathsOf(const Session& session, std::filesystem::path FilePair::*member) {
  py::list paths;
  for (const FilePair& pair : session.files.pairs) paths.append((pair.*member).string());
  return paths;
}

}  // namespace

void BindSimulate(py::module_& module) {
  py::class_<Session>(module, "Session", "The files of a calibration, paired by name.")
      .def_static(
          "read",
          [](const std::string& path, const std::string& camera_name) {
            return ValueOf(ReadSession(path, camera_name));
          },
          py::arg("path"), py::arg("camera_name") = "",
          "A session file, a folder with session.yaml or of simulate(), or a recording of ROS.")
      .def_property_readonly("images",
                             [](const Session& s) { return PathsOf(s, &FilePair::image); })
      .def_property_readonly("clouds",
                             [](const Session& s) { return PathsOf(s, &FilePair::cloud); })
      .def_property_readonly("boards", [](const Session& s) { return s.boards.string(); })
      .def_property_readonly("camera", [](const Session& s) { return s.camera.string(); })
      .def_property_readonly(
          "true_matrix", [](const Session& s) { return OptionalMatrix(s.true_cam_from_lidar); },
          "The true cam_from_lidar, (4, 4), of a simulated session; else None.");
  module.def("simulate_session", &Simulate, py::arg("scene"), py::arg("out"), py::kw_only(),
             py::arg("scans"), py::arg("seed"), py::arg("level"), py::arg("interval_s"),
             py::arg("ideal"));
}

}  // namespace sextant::python
