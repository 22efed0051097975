// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/session_fault.h"

#include <algorithm>

#include "calibrate/observe/board_scale.h"

namespace sextant {
namespace {

constexpr double kBoardExcess = 0.02;
constexpr double kPrintExcess = 0.03;
constexpr double kFocalExcess = 0.01;
constexpr double kPrintShift_m = 0.03;

void ShiftPrint(const Eigen::Vector2d& by_m, Board& board) {
  for (BoardTag& tag : board.tags) tag.center_in_board_m += by_m;
  if (board.checker) board.checker->center_in_board_m += by_m;
}

// Words that name the cause or its remedy; one of them is enough.
std::vector<std::string_view> WordsFor(SessionFault fault) {
  switch (fault) {
    case SessionFault::kNone:
    case SessionFault::kFalseBoard:
      return {};
    case SessionFault::kBoardSize:
    case SessionFault::kSquareSize:
      return {"easure the print", "easure the board", "size of the print", "board file"};
    case SessionFault::kExchangedScans:
      return {"one moment", "different moments", "contradict"};
    case SessionFault::kFocalLength:
      return {"focal length", "camera file", "intrinsics"};
    case SessionFault::kSensorMoved:
      return {"sensor moved"};
    case SessionFault::kOtherLens:
      return {"lens", "intrinsics", "camera file", "focal length"};
    case SessionFault::kUnsynchronised:
      return {"one moment", "different moments", "at rest", "was the board still"};
    case SessionFault::kPrintShifted:
      return {"place of the print"};
  }
  return {};
}

}  // namespace

const std::vector<std::string>& SessionFaultNames() {
  static const std::vector<std::string> names = {
      "none",        "board_size", "exchanged_scans", "focal_length", "sensor_moved",
      "false_board", "other_lens", "unsynchronised",  "square_size",  "print_shifted"};
  return names;
}

Board StatedBoard(const Board& board, SessionFault fault) {
  Board stated = board;
  if (fault == SessionFault::kBoardSize) {
    ScaleOutline(1.0 + kBoardExcess, stated);
    ScalePrint(1.0 + kBoardExcess, stated);
  }
  if (fault == SessionFault::kSquareSize) ScalePrint(1.0 + kPrintExcess, stated);
  if (fault == SessionFault::kPrintShifted) ShiftPrint({kPrintShift_m, 0.0}, stated);
  return stated;
}

Camera StatedCamera(const Camera& camera, SessionFault fault) {
  Camera stated = camera;
  if (fault == SessionFault::kFocalLength) {
    stated.fx_px *= 1.0 + kFocalExcess;
    stated.fy_px *= 1.0 + kFocalExcess;
  }
  if (fault == SessionFault::kOtherLens) {
    stated.model = CameraModel::kPinhole;
    stated.distortion.fill(0.0);
  }
  return stated;
}

std::optional<bool> NamesCause(SessionFault fault, std::string_view text) {
  const std::vector<std::string_view> words = WordsFor(fault);
  if (words.empty()) return std::nullopt;
  return std::ranges::any_of(
      words, [text](std::string_view word) { return text.find(word) != std::string_view::npos; });
}

}  // namespace sextant
