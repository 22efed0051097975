// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/board.h"
#include "geometry/camera.h"

namespace sextant {

/// What is wrong with a simulated session, in the order of SessionFaultNames().
enum class SessionFault {
  kNone,
  kBoardSize,       ///< The file states outline and print 2 percent too large.
  kExchangedScans,  ///< The scans of two views are exchanged.
  kFocalLength,     ///< The assumed focal lengths are 1 percent too long.
  kSensorMoved,     ///< The camera moves by 1 deg and 30 mm in the middle of the session.
  kFalseBoard,      ///< A plain plate of the board's size stands in the room.
  kOtherLens,       ///< A pinhole is assumed for a lens with distortion.
  kUnsynchronised,  ///< Boards move, and photo and scan are of different moments.
  kSquareSize,      ///< The file states the print 3 percent too large; the outline is right.
  kPrintShifted,    ///< The print is 30 mm off its stated place on the plate.
};

const std::vector<std::string>& SessionFaultNames();

/// The board as its file states it, and the camera as its file states it.
Board StatedBoard(const Board& board, SessionFault fault);
Camera StatedCamera(const Camera& camera, SessionFault fault);

/// Whether the text (verdict, advice and warnings) names the cause of the fault or the remedy for
/// it. None for kNone and kFalseBoard, which calls for no words where it is not mistaken.
std::optional<bool> NamesCause(SessionFault fault, std::string_view text);

}  // namespace sextant
