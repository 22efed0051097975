// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "cli/mark/mark_session.h"
#include "cli/mark/mark_viewport.h"

namespace sextant::cli {

/// What the window shows beneath the marks.
enum class MarkLayers { kBoth, kScan, kPhoto };

/// What a key requires of the window.
enum class MarkRequest { kNone, kSave, kQuit };

/// Keys that have no character.
enum class MarkKey : int { kLeft = 0x10000, kUp, kRight, kDown };

/// Translates mouse and keys of `sextant mark` into changes of the session and of the view.
/// Positions are in pixels of the canvas.
class MarkController {
 public:
  MarkController(MarkSession session, const MarkViewport& viewport, bool has_photo);

  /// A left click marks, unless the pointer moves meanwhile; then it drags the picture.
  void LeftDown(const Eigen::Vector2d& canvas);
  void LeftUp(const Eigen::Vector2d& canvas);
  void MiddleDown(const Eigen::Vector2d& canvas) { dragged_from_ = canvas; }
  void MiddleUp() { dragged_from_.reset(); }
  void RightDown() { session_.Undo(); }
  void Move(const Eigen::Vector2d& canvas);
  void Wheel(const Eigen::Vector2d& canvas, bool nearer);
  /// A character or a MarkKey.
  MarkRequest Press(int key);

  /// Shows a message to the user; `saved` marks the session as saved.
  void ShowMessage(std::string message, bool saved);

  const MarkSession& session() const { return session_; }
  const MarkViewport& viewport() const { return viewport_; }
  MarkLayers layers() const { return layers_; }
  bool shows_help() const { return shows_help_; }
  const std::optional<Eigen::Vector2d>& cursor() const { return cursor_; }
  /// The message of the window, else the session's note.
  const std::string& message() const { return message_.empty() ? session_.note() : message_; }

 private:
  MarkRequest Quit();
  /// Both return whether they handle the key.
  bool PressForMarks(int key);
  bool PressForView(int key);
  void ShowNextLayers();

  MarkSession session_;
  MarkViewport viewport_;
  bool has_photo_;
  MarkLayers layers_ = MarkLayers::kBoth;
  bool shows_help_ = false;
  bool quit_requested_ = false;
  std::string message_;
  std::optional<Eigen::Vector2d> cursor_;
  std::optional<Eigen::Vector2d> pressed_at_;
  std::optional<Eigen::Vector2d> dragged_from_;
};

}  // namespace sextant::cli
