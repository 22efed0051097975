// SPDX-License-Identifier: Apache-2.0
// calibrate(): a session, or images and scans in memory, to a Calibration.
#include <fmt/core.h>
#include <pybind11/stl.h>

#include "base/units.h"
#include "calibrate/calibrate.h"
#include "io/output/output_file.h"
#include "python/bindings.h"
#include "python/catalogue.h"
#include "python/module_types.h"
#include "python/raise.h"
#include "python/sensor_arrays.h"
#include "report/calibrate_text.h"

namespace sextant::python {
namespace {

/// sextant.Calibration: an answer with all that led to it.
struct ModuleCalibration {
  std::shared_ptr<const Calibration> all;

  const CalibrationResult& result() const { return *all->result; }
};

struct CalibrateRequest {
  std::vector<std::string> solvers;
  std::vector<Board> boards;
  std::optional<Camera> camera;
  py::object initial;
  std::string detector;
  std::string extractor;
  double need_mm = 0.0;
  double need_deg = 0.0;
  int bootstrap = 0;
};

CalibrateOptions OptionsOf(const CalibrateRequest& request) {
  CalibrateOptions options;
  options.boards = request.boards;
  options.camera = request.camera;
  options.observe.detector = request.detector;
  options.observe.extractor = request.extractor;
  options.bootstrap_samples = request.bootstrap;
  options.need = {.translation_m = 1e-3 * request.need_mm,
                  .rotation_rad = kRadPerDeg * request.need_deg};
  options.progress = [](std::string_view, std::size_t, std::size_t) { EndIfInterrupted(); };
  if (!request.initial.is_none()) options.match.initial = PoseFrom(request.initial, "initial");
  const std::shared_ptr<const SolverRegistry> registry = Catalogue();
  for (const std::string& spec : request.solvers) {
    options.solvers.push_back(ValueOf(registry->Make(spec)));
  }
  return options;
}

// Without an answer: the boards of each view and the reason, as the program prints both.
ModuleCalibration AnswerOf(Expected<Calibration> calibration) {
  auto all = std::make_shared<Calibration>(ValueOf(std::move(calibration)));
  if (!all->result) {
    Error error = all->result.error();
    error.message += "\n" + DescribeCalibration(*all);
    throw ErrorException(std::move(error));
  }
  return {std::move(all)};
}

ModuleCalibration CalibrateSession(const std::string& path, const std::string& camera_name,
                                   const CalibrateRequest& request) {
  const CalibrateOptions options = OptionsOf(request);
  return AnswerOf(WithoutGil([&] {
    return ReadSession(path, camera_name).and_then([&](const Session& session) {
      return Calibrate(session, options);
    });
  }));
}

ModuleCalibration CalibrateArrays(const py::list& images, const py::list& clouds,
                                  const CalibrateRequest& request) {
  if (images.size() != clouds.size() || images.empty()) {
    throw ErrorException({ErrorCode::kInvalidInput,
                          fmt::format("expected as many images as clouds, at least one; got {} and "
                                      "{}",
                                      images.size(), clouds.size())});
  }
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < images.size(); ++i) {
    frames.push_back({.name = fmt::format("{:03}", i),
                      .image = ImageFrom(images[i], fmt::format("images[{}]", i)),
                      .cloud = CloudFrom(clouds[i], fmt::format("clouds[{}]", i))});
  }
  const CalibrateOptions options = OptionsOf(request);
  return AnswerOf(WithoutGil([&] { return Calibrate(frames, options); }));
}

py::list ViewsOf(const ModuleCalibration& calibration) {
  py::list views;
  for (const ResultView& view : calibration.result().views) {
    py::dict fields;
    fields["name"] = view.name;
    fields["kept"] = view.kept;
    fields["reason"] = view.reason;
    fields["rmse_m"] = view.rmse_m;
    fields["rmse_px"] = view.rmse_px;
    fields["held_out_m"] = view.held_out_m;
    fields["held_out_px"] = view.held_out_px;
    views.append(fields);
  }
  return views;
}

py::list BoardFates(const ModuleCalibration& calibration) {
  const Assembly& assembly = calibration.all->assembly;
  py::list rows;
  for (const BoardRow& row : assembly.rows) {
    const int id =
        row.board < 0 ? -1 : assembly.problem.boards[static_cast<std::size_t>(row.board)].id;
    rows.append(py::make_tuple(calibration.all->observed.views[row.view].name, id,
                               std::string(ToString(row.fate)), row.why));
  }
  return rows;
}

py::object CovarianceOrNone(const ModuleCalibration& calibration) {
  const std::optional<Matrix6d>& covariance = calibration.result().covariance;
  return covariance ? py::object(MatrixArray(*covariance)) : py::object(py::none());
}

py::object SigmaOrNone(const ModuleCalibration& calibration) {
  const std::optional<Matrix6d>& covariance = calibration.result().covariance;
  if (!covariance) return py::none();
  const Vector6d sigma = covariance->diagonal().cwiseMax(0.0).cwiseSqrt();
  return ArrayOf(std::span<const double>(sigma.data(), 6));
}

ModuleProblem ProblemOf(const ModuleCalibration& calibration) {
  const ProblemFile file = ProblemFileOf(*calibration.all);
  return {.data = std::make_shared<CalibrationProblem>(file.problem),
          .true_cam_from_lidar = file.true_cam_from_lidar,
          .input = {.path = {},
                    .format = "calibration",
                    .pairs_3d3d = static_cast<int>(file.problem.pairs_3d3d.size()),
                    .pairs_2d3d = static_cast<int>(file.problem.pairs_2d3d.size())}};
}

void BindResult(py::class_<ModuleCalibration>& calibration) {
  using C = ModuleCalibration;
  calibration
      .def_property_readonly(
          "matrix", [](const C& c) { return PoseArray(c.result().cam_from_lidar); },
          "cam_from_lidar, (4, 4) [m]: point_in_cam = matrix @ point_in_lidar.")
      .def_property_readonly(
          "inverse", [](const C& c) { return PoseArray(c.result().cam_from_lidar.Inverse()); },
          "lidar_from_cam, (4, 4) [m].")
      .def_property_readonly("covariance", &CovarianceOrNone,
                             "(6, 6) of (dphi [rad], dt [m]), enlarged to what the checks show.")
      .def_property_readonly("sigma", &SigmaOrNone, "1 sigma of (dphi [rad], dt [m]), (6,).")
      .def_property_readonly(
          "alternatives", [](const C& c) { return PosesArray(c.all->report()->alternatives); },
          "Other poses that explain the data about as well, (K, 4, 4).")
      .def_property_readonly(
          "verdict",
          [](const C& c) { return std::string(ToString(c.result().verdict->usability)); },
          "\"GOOD\", \"USABLE WITH CARE\" or \"NOT USABLE\".")
      .def_property_readonly("reason", [](const C& c) { return c.result().verdict->reason; })
      .def_property_readonly(
          "next", [](const C& c) { return c.result().verdict->next; },
          "What to do next, in one sentence.")
      .def_property_readonly("warnings", [](const C& c) { return c.result().warnings; })
      .def_property_readonly("closing", [](const C& c) { return c.result().closing; })
      .def_property_readonly("solver", [](const C& c) { return c.result().solver; });
}

}  // namespace

void BindCalibrate(py::module_& module) {
  using C = ModuleCalibration;
  py::class_<CalibrateRequest>(module, "CalibrateRequest")
      .def(py::init<std::vector<std::string>, std::vector<Board>, std::optional<Camera>, py::object,
                    std::string, std::string, double, double, int>());
  py::class_<C> calibration(module, "Calibration", "cam_from_lidar of images and scans of boards.");
  BindResult(calibration);
  calibration
      .def_property_readonly("views", &ViewsOf,
                             "A dict for each view: name, kept, reason, and residuals [m, px].")
      .def_property_readonly(
          "boards", &BoardFates,
          "What became of each board in each view: (view, id of the board, or -1\n"
          "for the view as a whole, status, why).")
      .def_property_readonly("problem", &ProblemOf, "The pairs, for solve() and compare().")
      .def(
          "to_json", [](const C& c) { return FormatCalibrationResultJson(c.result()); },
          "What `sextant calibrate --json` writes.")
      .def(
          "to_yaml", [](const C& c) { return FormatCalibrationResult(c.result()); },
          "The result file, for `sextant project`, `export` and `advise`.")
      .def(
          "save",
          [](const C& c, const std::string& path) {
            ValueOf(WriteFileAtomically(path, FormatCalibrationResult(c.result())));
          },
          py::arg("path"), "Writes the result file, whole or not at all; replaces an existing one.")
      .def("__repr__", [](const C& c) { return DescribeCalibration(*c.all); })
      .def("_repr_html_", [](const py::object& self) {
        return py::module_::import("sextant._notebook").attr("calibration_html")(self);
      });
  module.def("calibrate_session", &CalibrateSession);
  module.def("calibrate_arrays", &CalibrateArrays);
}

}  // namespace sextant::python
