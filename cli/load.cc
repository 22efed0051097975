// SPDX-License-Identifier: Apache-2.0
#include "cli/load.h"

#include <fmt/core.h>

#include <filesystem>
#include <vector>

#include "io/boards/board_file.h"
#include "io/boards/marker_files.h"
#include "io/cameras/camera_file.h"
#include "io/problems/read_problem.h"
#include "io/text/text_file.h"

namespace sextant::cli {
namespace {

// Sizes are all that is asked of boards here, so a marker_coordinates.txt may have any number.
Expected<std::vector<Board>> ReadNamedBoards(const std::filesystem::path& path) {
  if (path.extension() == ".yaml" || path.extension() == ".yml") return ReadBoards(path);
  return ReadMarkerCoordinates(path).map(BoardsOf);
}

Expected<void> AddNamedFiles(const InputOptions& options, CalibrationProblem& problem) {
  if (!options.camera_path.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const Camera camera, ReadCamera(options.camera_path));
    problem.camera = camera;
  }
  if (!options.boards_path.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const std::vector<Board> boards, ReadNamedBoards(options.boards_path));
    problem.boards = boards;
  }
  return {};
}

}  // namespace

Expected<LoadedInput> Load(const InputOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const DetectedProblem read, ReadProblem(options.problem_path));
  LoadedInput input;
  input.file = read;
  input.notes = read.notes;
  CalibrationProblem& problem = input.file.problem;
  SEXTANT_RETURN_IF_ERROR(AddNamedFiles(options, problem));
  input.judgement = DiagnosePairs(problem);
  if (options.reorder && input.judgement.order) {
    problem = Reordered(problem, *input.judgement.order);
  }
  input.summary = {.path = options.problem_path,
                   .format = std::string(ToString(read.format)),
                   .pairs_3d3d = static_cast<int>(problem.pairs_3d3d.size()),
                   .pairs_2d3d = static_cast<int>(problem.pairs_2d3d.size()),
                   .points_in_cam = static_cast<int>(problem.point_sets.in_cam.size()),
                   .points_in_lidar = static_cast<int>(problem.point_sets.in_lidar.size())};
  return input;
}

int Refuse(const char* command, const Error& error, int exit_code) {
  fmt::print(stderr, "sextant {}: {}\n", command, error.message);
  return exit_code;
}

int Deliver(const char* command, const std::string& json_path, const std::string& text,
            const std::string& json, int exit_code) {
  if (json_path == "-") {
    fmt::print("{}", json);
    return exit_code;
  }
  fmt::print("{}", text);
  if (json_path.empty()) return exit_code;
  if (Expected<void> ok = WriteFileAtomically(json_path, json); !ok) {
    return Refuse(command, ok.error());
  }
  return exit_code;
}

}  // namespace sextant::cli
