// SPDX-License-Identifier: Apache-2.0
#include "cli/mark/mark_window.h"

#include <chrono>
#include <opencv2/core/utility.hpp>
#include <opencv2/highgui.hpp>
#include <string>

namespace sextant::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kTitle = "sextant mark";
constexpr int kWait_ms = 15;
constexpr auto kWheelRest = std::chrono::milliseconds(150);

// X11 has codes of its own for the cursor keys; other keys are characters.
int KeyOf(int code) {
  constexpr int kFirst = 0xff51;  // left, up, right, down
  const int key = code & 0xffff;
  if (key >= kFirst && key < kFirst + 4) return static_cast<int>(MarkKey::kLeft) + key - kFirst;
  return key & 0xff;
}

// Only OpenCV's build information states which library draws its windows ("QT: YES ...").
bool HasQtWindows() {
  const std::string information = cv::getBuildInformation();
  const std::size_t line = information.find(" QT:");
  return line != std::string::npos &&
         information.substr(line, information.find('\n', line) - line).find("YES") !=
             std::string::npos;
}

// OpenCV's window for the controller. Its Qt window magnifies the picture itself when the wheel
// turns, and no call undoes that; so a new window replaces the old one when the wheel is at rest.
class Window {
 public:
  Window(MarkController& controller, MarkCanvas& canvas, const MarkWindowCalls& calls)
      : controller_(controller), canvas_(canvas), calls_(calls) {}

  void Run() {
    Open();
    while (true) {
      if (!magnified_ && stale_) Show();
      const int code = cv::waitKeyEx(kWait_ms);
      if (reports_visibility_ && !IsVisible()) break;
      if (code >= 0 && Press(KeyOf(code)) == MarkRequest::kQuit) break;
      if (magnified_ && Clock::now() - wheel_at_ > kWheelRest) Replace();
    }
    calls_.changed();
    cv::destroyAllWindows();
  }

 private:
  static void OnMouse(int event, int x, int y, int flags, void* self) {
    static_cast<Window*>(self)->Mouse(event, {x, y}, flags);
  }

  void Open() {
    name_ = std::string(kTitle) + (name_.ends_with('.') ? "" : ".");
    cv::namedWindow(name_, cv::WINDOW_AUTOSIZE | cv::WINDOW_GUI_NORMAL);
    cv::setWindowTitle(name_, kTitle);
    cv::setMouseCallback(name_, &Window::OnMouse, this);
    Show();
  }

  void Show() {
    cv::imshow(name_, canvas_.Draw(controller_));
    stale_ = false;
    if (!reports_visibility_) {
      cv::waitKeyEx(1);
      reports_visibility_ = IsVisible();
    }
  }

  bool IsVisible() const { return cv::getWindowProperty(name_, cv::WND_PROP_VISIBLE) > 0.5; }

  void Replace() {
    const std::string old = name_;
    const cv::Rect place = cv::getWindowImageRect(old);
    Open();
    if (place.x >= 0 && place.y >= 0) cv::moveWindow(name_, place.x, place.y);
    cv::destroyWindow(old);
    magnified_ = false;
    stale_ = true;
  }

  void Mouse(int event, const Eigen::Vector2d& at, int flags) {
    if (magnified_ && event != cv::EVENT_MOUSEWHEEL) return;
    stale_ = true;
    switch (event) {
      case cv::EVENT_MOUSEMOVE:
        controller_.Move(at);
        return;
      case cv::EVENT_LBUTTONDOWN:
      case cv::EVENT_LBUTTONDBLCLK:
        controller_.LeftDown(at);
        return;
      case cv::EVENT_LBUTTONUP:
        controller_.LeftUp(at);
        break;
      case cv::EVENT_MBUTTONDOWN:
        controller_.MiddleDown(at);
        return;
      case cv::EVENT_MBUTTONUP:
        controller_.MiddleUp();
        return;
      case cv::EVENT_RBUTTONDOWN:
      case cv::EVENT_RBUTTONDBLCLK:
        controller_.RightDown();
        break;
      case cv::EVENT_MOUSEWHEEL:
        if (!magnified_) wheel_anchor_ = at;  // The magnified picture reports other positions.
        controller_.Wheel(wheel_anchor_, cv::getMouseWheelDelta(flags) > 0);
        magnified_ = is_qt_;
        wheel_at_ = Clock::now();
        return;
      default:
        return;
    }
    calls_.changed();
  }

  MarkRequest Press(int key) {
    const MarkRequest request = controller_.Press(key);
    stale_ = true;
    if (request == MarkRequest::kSave) calls_.save();
    calls_.changed();
    return request;
  }

  MarkController& controller_;
  MarkCanvas& canvas_;
  const MarkWindowCalls& calls_;
  std::string name_;
  const bool is_qt_ = HasQtWindows();
  bool stale_ = true;
  bool reports_visibility_ = false;
  bool magnified_ = false;
  Clock::time_point wheel_at_{};
  Eigen::Vector2d wheel_anchor_ = Eigen::Vector2d::Zero();
};

}  // namespace

Expected<void> RunMarkWindow(MarkController& controller, MarkCanvas& canvas,
                             const MarkWindowCalls& calls) {
  try {
    Window(controller, canvas, calls).Run();
  } catch (const cv::Exception& error) {
    return MakeError(ErrorCode::kIo, "cannot show a window: " + error.err);
  }
  return {};
}

}  // namespace sextant::cli
