// SPDX-License-Identifier: Apache-2.0
// sextant.Board, and boards in images and in scans.
#include <fmt/core.h>
#include <pybind11/stl.h>

#include "calibrate/observe/photo_file.h"
#include "features/camera/grey_image.h"
#include "features/lidar/rings/scan_rings.h"
#include "io/boards/board_file.h"
#include "io/clouds/cloud_file.h"
#include "python/bindings.h"
#include "python/raise.h"
#include "python/sensor_arrays.h"
#include "report/boards_report.h"
#include "report/detect_report.h"

namespace sextant::python {
namespace {

// Without a path the messages are those of the library alone.
Error AtPath(const std::string& path, const Error& error) {
  return path.empty() ? error : Error(error.code, path + ": " + error.message);
}

// Tags that are missing are listed without a search for the reason.
void ListMissingTags(ImageReport& report) {
  for (const SeenBoard& seen : report.seen.boards) {
    for (const std::size_t tag : seen.missing_tags) {
      report.missing.push_back({.board = seen.index,
                                .tag = tag,
                                .why = {.cause = MissingCause::kNotThere, .text = "not examined"}});
    }
  }
}

Expected<ImageReport> FindInImage(const cv::Mat& image, const std::vector<Board>& boards,
                                  const std::optional<Camera>& camera,
                                  const std::string& detector) {
  ImageReport report{.path = {}, .size = image.size()};
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat grey, ToGrey(image));
  if (boards.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(
        const TagDetectorPtr tags,
        MakeTagDetector(detector.empty() ? "apriltag(family=tag36h11)" : detector));
    SEXTANT_ASSIGN_OR_RETURN(Detections found, tags->Detect(grey));
    report.seen.other_tags = std::move(found.tags);
    report.checkers = std::move(found.checkers);
    return report;
  }
  SEXTANT_ASSIGN_OR_RETURN(const BoardFinder finder, BoardFinder::Make(boards, camera, detector));
  SEXTANT_ASSIGN_OR_RETURN(SeenBoards seen, finder.Find(grey));
  report.seen = std::move(seen);
  ListMissingTags(report);
  return report;
}

py::tuple DetectInImage(const py::object& image, const std::string& path,
                        const std::vector<Board>& boards, const std::optional<Camera>& camera,
                        const std::string& detector) {
  const cv::Mat pixels = path.empty() ? ImageFrom(image, "image") : ValueOf(ReadImage(path));
  Expected<ImageReport> report =
      WithoutGil([&] { return FindInImage(pixels, boards, camera, detector); });
  if (!report) throw ErrorException(AtPath(path, report.error()));
  report->path = path;
  const std::string text = DescribeDetection(*report, boards);
  return py::make_tuple(FormatDetections({path}, {report}, boards), text);
}

ScanReport FindInScan(const PointCloud& cloud, const std::vector<Board>& boards,
                      const std::string& extractor, const BoardSearchOptions& options) {
  ScanReport report;
  const ScanRings rings = ValueOf(ScanRings::Build(cloud));
  report.returns = static_cast<int>(rings.points().size());
  report.rings = rings.rings();
  report.search = ValueOf(FindBoards(rings, boards, options));
  for (const BoardPatch& patch : report.search.found) {
    report.corners.push_back(
        ExtractCorners(extractor, patch, boards[static_cast<std::size_t>(patch.board)]));
  }
  return report;
}

py::tuple BoardsInScan(const py::object& scan, const std::string& path,
                       const std::vector<Board>& boards, const std::string& extractor,
                       std::uint64_t seed) {
  const PointCloud cloud = path.empty() ? CloudFrom(scan, "scan") : ValueOf(ReadCloud(path));
  // Whether the extractor's name is known, before the search.
  if (const auto known = ExtractCorners(extractor, {}, {});
      !known && known.error().code == ErrorCode::kUnknownName) {
    throw ErrorException(known.error());
  }
  BoardSearchOptions options;
  options.seed = seed;
  std::vector<ScanReport> reports;
  try {
    reports.push_back(WithoutGil([&] { return FindInScan(cloud, boards, extractor, options); }));
  } catch (const ErrorException& exception) {
    throw ErrorException(AtPath(path, exception.error()));
  }
  reports.front().path = path;
  return py::make_tuple(ScansJson(reports, boards, extractor),
                        DescribeScans(reports, boards, extractor));
}

std::string BoardRepr(const Board& board) {
  return fmt::format("<sextant.Board id {}, {} x {} m, {} tags{}>", board.id, board.top_right_m,
                     board.right_bottom_m, board.tags.size(),
                     board.checker ? ", a checkerboard" : "");
}

}  // namespace

void BindBoards(py::module_& module) {
  py::class_<Board>(module, "Board",
                    "A rectangular board: origin at its centre, x right, y down, z into it.\n\n"
                    "Corners are numbered clockwise from (-x, -y); read_boards() makes boards.")
      .def_readonly("id", &Board::id)
      .def_readonly("name", &Board::name)
      .def_readonly("width_m", &Board::top_right_m, "Along x [m].")
      .def_readonly("height_m", &Board::right_bottom_m, "Along y [m].")
      .def_property_readonly(
          "corners",
          [](const Board& b) { return ArrayOf(std::span<const Eigen::Vector3d>(BoardCorners(b))); },
          "Corners in the board's frame, (4, 3) [m], or (8, 3) with those of an opening.")
      .def("__repr__", &BoardRepr);
  module.def(
      "read_boards", [](const std::string& path) { return ValueOf(ReadBoards(path)); },
      py::arg("path"));
  module.def(
      "parse_boards", [](const std::string& text) { return ValueOf(ParseBoards(text, "boards")); },
      py::arg("text"));
  module.def(
      "read_cloud",
      [](const std::string& path) {
        return ArrayOf(WithoutGil([&] { return ValueOf(ReadCloud(path)); }));
      },
      py::arg("path"));
  module.def(
      "read_image",
      [](const std::string& path) {
        return ArrayOf(WithoutGil([&] { return ValueOf(ReadImage(path)); }));
      },
      py::arg("path"));
  module.def("detect_in_image", &DetectInImage);
  module.def("boards_in_scan", &BoardsInScan);
}

}  // namespace sextant::python
