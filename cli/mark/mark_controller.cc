// SPDX-License-Identifier: Apache-2.0
#include "cli/mark/mark_controller.h"

namespace sextant::cli {
namespace {

constexpr double kWheelStep = 1.25;
constexpr double kKeyStep = 1.5;
constexpr double kPanStep_px = 80.0;
constexpr double kClickSlack_px = 4.0;  // Maximum movement during a click.

}  // namespace

MarkController::MarkController(MarkSession session, const MarkViewport& viewport, bool has_photo)
    : session_(std::move(session)), viewport_(viewport), has_photo_(has_photo) {}

void MarkController::LeftDown(const Eigen::Vector2d& canvas) { pressed_at_ = canvas; }

void MarkController::LeftUp(const Eigen::Vector2d& canvas) {
  dragged_from_.reset();
  if (!pressed_at_) return;
  const Eigen::Vector2d at = *pressed_at_;
  pressed_at_.reset();
  if ((canvas - at).norm() > kClickSlack_px) return;
  message_.clear();
  quit_requested_ = false;
  session_.Click(viewport_.ToPixel(at));
}

void MarkController::Move(const Eigen::Vector2d& canvas) {
  cursor_ = canvas;
  if (pressed_at_ && (canvas - *pressed_at_).norm() > kClickSlack_px) {
    dragged_from_ = pressed_at_;
    pressed_at_.reset();
  }
  if (!dragged_from_) return;
  viewport_.Pan(canvas - *dragged_from_);
  dragged_from_ = canvas;
}

void MarkController::Wheel(const Eigen::Vector2d& canvas, bool nearer) {
  viewport_.ZoomAt(canvas, nearer ? kWheelStep : 1.0 / kWheelStep);
}

MarkRequest MarkController::Press(int key) {
  constexpr int kEscape = 27;
  const bool quits = key == 'q' || key == kEscape;
  if (!quits) quit_requested_ = false;
  message_.clear();
  if (quits) return Quit();
  if (key == 's') return MarkRequest::kSave;
  if (!PressForMarks(key)) PressForView(key);
  return MarkRequest::kNone;
}

bool MarkController::PressForMarks(int key) {
  constexpr int kBackspace = 8;
  switch (key) {
    case 'u':
    case kBackspace:
      session_.Undo();
      return true;
    case 'r':
      session_.Redo();
      return true;
    case 'd':
      session_.DeleteBoard();
      return true;
    case 'n':
      session_.SelectBoard(+1);
      return true;
    case 'b':
      session_.SelectBoard(-1);
      return true;
    case 'e':
      session_.SetMode(MarkMode::kEdges);
      return true;
    case 'c':
      if (has_photo_) {
        session_.SetMode(MarkMode::kCorners);
      } else {
        message_ = "corners are marked in a photo: give --image";
      }
      return true;
    default:
      return false;
  }
}

bool MarkController::PressForView(int key) {
  const Eigen::Vector2d at = cursor_.value_or(viewport_.canvas_center());
  switch (key) {
    case 'v':
      ShowNextLayers();
      return true;
    case 'h':
    case '?':
      shows_help_ = !shows_help_;
      return true;
    case '+':
    case '=':
      viewport_.ZoomAt(at, kKeyStep);
      return true;
    case '-':
      viewport_.ZoomAt(at, 1.0 / kKeyStep);
      return true;
    case 'f':
    case '0':
      viewport_.Fit();
      return true;
    case static_cast<int>(MarkKey::kLeft):
      viewport_.Pan({kPanStep_px, 0.0});
      return true;
    case static_cast<int>(MarkKey::kRight):
      viewport_.Pan({-kPanStep_px, 0.0});
      return true;
    case static_cast<int>(MarkKey::kUp):
      viewport_.Pan({0.0, kPanStep_px});
      return true;
    case static_cast<int>(MarkKey::kDown):
      viewport_.Pan({0.0, -kPanStep_px});
      return true;
    default:
      return false;
  }
}

MarkRequest MarkController::Quit() {
  if (session_.IsSaved() || quit_requested_) return MarkRequest::kQuit;
  quit_requested_ = true;
  message_ = "Not saved: s saves; q again quits, and the marks are kept for the next start";
  return MarkRequest::kNone;
}

void MarkController::ShowNextLayers() {
  if (!has_photo_) {
    message_ = "there is no photo to show: give --image";
    return;
  }
  layers_ = layers_ == MarkLayers::kBoth   ? MarkLayers::kScan
            : layers_ == MarkLayers::kScan ? MarkLayers::kPhoto
                                           : MarkLayers::kBoth;
}

void MarkController::ShowMessage(std::string message, bool saved) {
  message_ = std::move(message);
  if (saved) session_.MarkSaved();
}

}  // namespace sextant::cli
