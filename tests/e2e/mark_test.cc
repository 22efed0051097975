// SPDX-License-Identifier: Apache-2.0
// `sextant mark` as a person uses it: a window on a display, a mouse and keys.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>
#include <opencv2/core.hpp>

#include "cli/mark/mark_canvas.h"
#include "cli/mark/mark_viewport.h"
#include "features/lidar/corner_extractor.h"
#include "features/lidar/polygon_edges.h"
#include "io/boards/polygon_file.h"
#include "io/clouds/pcd_file.h"
#include "io/results/results_json.h"
#include "support/display/virtual_display.h"
#include "support/drawn_board.h"
#include "support/pictures.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using cli::MarkViewport;
using test::BackgroundProgram;
using test::Eventually;
using test::TestFolder;
using test::TestPath;
using test::VirtualDisplay;
using testing::HasSubstr;

constexpr int kWidth = 1280;
constexpr int kHeight = 800;
constexpr double kSeconds =
    20.0;  // Limit for what takes a fraction of a second on an idle machine.

// A scan of the paper's board, and the projection of the window.
struct Drawing {
  Scene scene = test::PlacedBoards(1);
  ScanMarks projection{.camera = AssumedCamera(1280, 720), .cam_from_lidar = AxesCamFromLidar()};
  MarkViewport view{kWidth, kHeight, cli::kMarkBar_px, 1280, 720};
  MarkedBoard board = test::DrawBoard(0, test::CornersOf(scene.boards[0], {}), projection, 0.05);
};

void WriteScan(const Scene& scene) {
  const SimulatedScan scan = test::Scan(scene, test::Model("vlp16"), {.seed = 5});
  test::WriteText(TestPath("scan.pcd"), FormatPcd(scan.cloud));
}

// Corners of the scan in the file, extracted by the marks. The median errors of these extractors
// are 2.2, 4.7 and 12 mm; `max_m` is about four times as much.
void ExpectCornersNear(const SceneBoard& board, const ScanMarks& marks, const char* extractor,
                       double max_m) {
  const Expected<PointCloud> cloud = ReadPcd(TestPath("scan.pcd"));
  ASSERT_TRUE(cloud) << cloud.error().message;
  const auto patches =
      PatchesFromPolygons(*ScanRings::Build(*cloud), marks, std::vector<Board>{board.board});
  ASSERT_TRUE(patches) << patches.error().message;
  const auto corners = ExtractCorners(extractor, patches->front(), board.board);
  ASSERT_TRUE(corners) << corners.error().message;
  const test::BoardCorners truth = test::CornersOf(board, {});
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT((corners->in_lidar[i] - truth[i]).norm(), max_m) << extractor << " " << i;
  }
}

// The window, once it shows.
class OpenWindow {
 public:
  OpenWindow(const VirtualDisplay& display, const std::vector<std::string>& more = {})
      : display_(display), program_(Command(more), {display.variable()}, TestPath("log")) {
    id_ = FindWindow("--sync");
    EXPECT_NE(id_, "") << test::ReadText(TestPath("log"));
  }

  int Wait() { return program_.Wait(kSeconds); }

  // HighGUI keeps the last key only, and calls back for a click before the program sees the key
  // that came first: each key is pressed when nothing else is waiting, and then handled.
  void Press(const std::string& key) {
    Eventually(kSeconds, [&] { return program_.Rests(); });
    display_.Do("key " + key);
    Eventually(kSeconds, [&] { return program_.Rests(); });
  }

  // The window is in the corner of the screen, because no window manager moves it.
  void Click(const std::vector<Eigen::Vector2d>& canvas, int button = 1) {
    std::string events;
    for (const Eigen::Vector2d& at : canvas) {
      events += fmt::format("mousemove {:.0f} {:.0f} click {} ", at.x(), at.y(), button);
    }
    display_.Do(events);
  }

  // Turns the wheel, and waits for the window that may replace this one.
  void TurnWheel(const Eigen::Vector2d& canvas, int notches) {
    Click({canvas}, 2);  // Middle: does nothing but shows that the pointer is there.
    display_.Do(fmt::format("click --repeat {} --delay 0 4", notches));
    Eventually(0.5 * kSeconds, [&] {
      const std::string now = FindWindow("");
      return now != id_ && !now.empty() && now.find('\n') == now.rfind('\n');
    });
    id_ = FindWindow("");
  }

 private:
  static std::vector<std::string> Command(const std::vector<std::string>& more) {
    std::vector<std::string> command = {SEXTANT_BINARY,       "mark",  "--cloud",
                                        TestPath("scan.pcd"), "--out", TestPath("polygons.yaml")};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }

  std::string FindWindow(const char* option) const {
    return display_.Do(fmt::format("search {} --onlyvisible --name '^sextant mark$'", option));
  }

  const VirtualDisplay& display_;
  BackgroundProgram program_;
  std::string id_;
};

std::vector<Eigen::Vector2d> OnCanvas(const MarkViewport& view, const Quadrilateral& edge) {
  std::vector<Eigen::Vector2d> clicks;
  for (const Eigen::Vector2d& pixel : edge) clicks.push_back(view.ToCanvas(pixel));
  return clicks;
}

// Whether the autosave file gets that many edges and clicks in time.
bool IsKept(std::size_t edges, std::size_t clicks) {
  return Eventually(kSeconds, [&] {
    const Expected<ScanMarks> kept = ReadPolygons(TestPath("polygons.yaml.autosave"));
    if (!kept) return false;
    const std::size_t found = kept->boards.empty() ? 0 : kept->boards[0].edges.size();
    return found == edges && kept->unfinished.size() == clicks;
  });
}

TEST(Mark, ABoardDrawnByClicksIsSaved) {
  if (!VirtualDisplay::IsInstalled()) GTEST_SKIP() << VirtualDisplay::kAbsent;
  const Drawing drawing;
  WriteScan(drawing.scene);
  const VirtualDisplay display(TestFolder().string());
  OpenWindow window(display);
  const std::vector<Quadrilateral>& edges = drawing.board.edges;
  window.Click(OnCanvas(drawing.view, edges[0]));
  ASSERT_TRUE(IsKept(1, 0));
  window.Click({{300, 300}, {310, 310}});
  ASSERT_TRUE(IsKept(1, 2));
  window.Click({{400, 400}}, 3);  // The right button undoes.
  window.Press("u");
  ASSERT_TRUE(IsKept(1, 0));
  window.Click(OnCanvas(drawing.view, edges[1]));
  ASSERT_TRUE(IsKept(2, 0));
  MarkViewport near = drawing.view;
  const Eigen::Vector2d at(640, 400);
  window.TurnWheel(at, 2);
  near.ZoomAt(at, 1.25 * 1.25);
  window.Click(OnCanvas(near, edges[2]));
  window.Click(OnCanvas(near, edges[3]));
  ASSERT_TRUE(IsKept(4, 0));
  window.Press("s");
  ASSERT_TRUE(Eventually(kSeconds, [] {
    return std::filesystem::exists(TestPath("polygons.yaml")) &&
           !std::filesystem::exists(TestPath("polygons.yaml.autosave"));
  }));
  window.Press("q");
  EXPECT_EQ(window.Wait(), 0);
  EXPECT_THAT(test::ReadText(TestPath("log")), HasSubstr("1 board with 4 edges, 0 corners"));

  const Expected<ScanMarks> marks = ReadPolygons(TestPath("polygons.yaml"));
  ASSERT_TRUE(marks) << marks.error().message;
  ASSERT_EQ(marks->boards.size(), 1U);
  ASSERT_EQ(marks->boards[0].edges.size(), 4U);
  EXPECT_TRUE(marks->unfinished.empty());
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      // The pointer is on whole pixels of the canvas, within half a pixel of the intended position.
      EXPECT_LT((marks->boards[0].edges[i][k] - edges[i][k]).norm(), 0.8) << i << " " << k;
    }
  }
  ExpectCornersNear(drawing.scene.boards[0], *marks, "rectangle", 0.010);
  ExpectCornersNear(drawing.scene.boards[0], *marks, "plane_lines", 0.020);
  ExpectCornersNear(drawing.scene.boards[0], *marks, "lines3d", 0.050);
}

TEST(Mark, UnsavedMarksAreThereAtTheNextStart) {
  if (!VirtualDisplay::IsInstalled()) GTEST_SKIP() << VirtualDisplay::kAbsent;
  const Drawing drawing;
  WriteScan(drawing.scene);
  test::WritePicture(TestPath("photo.png"), cv::Mat(720, 1280, CV_8UC3, cv::Scalar(90, 120, 90)));
  const VirtualDisplay display(TestFolder().string());
  {
    OpenWindow window(display);
    window.Click(OnCanvas(drawing.view, drawing.board.edges[0]));
    window.Click({{300, 300}});
    ASSERT_TRUE(IsKept(1, 1));
    window.Press("q");
    window.Press("q");  // The first one warns.
    EXPECT_EQ(window.Wait(), 1);
    EXPECT_THAT(test::ReadText(TestPath("log")), HasSubstr("polygons.yaml.autosave"));
  }
  EXPECT_FALSE(std::filesystem::exists(TestPath("polygons.yaml")));
  OpenWindow window(display, {"--image", TestPath("photo.png")});
  window.Click({{340, 300}, {340, 340}, {300, 340}});
  ASSERT_TRUE(IsKept(2, 0));
  window.Press("c");
  window.Click({{600, 200}, {700, 300}});
  window.Press("s");
  window.Press("q");
  EXPECT_EQ(window.Wait(), 0) << test::ReadText(TestPath("log"));
  const Expected<ScanMarks> marks = ReadPolygons(TestPath("polygons.yaml"));
  ASSERT_TRUE(marks) << marks.error().message;
  EXPECT_EQ(marks->boards[0].edges.size(), 2U);
  ASSERT_EQ(marks->corners.size(), 2U);
  EXPECT_EQ(marks->corners[1].corner, 1);
  EXPECT_LT((marks->corners[1].pixel - drawing.view.ToPixel({700, 300})).norm(), 0.8);
}

test::ProgramRun Mark(const std::string& arguments) {
  return test::RunProgram(std::string("env -u DISPLAY -u WAYLAND_DISPLAY ") + SEXTANT_BINARY,
                          "mark " + arguments);
}

TEST(Mark, WithoutADisplayItGivesAdvice) {
  const test::ProgramRun none = Mark("--cloud scan.pcd");
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("DISPLAY is not set"));
  EXPECT_THAT(none.err, HasSubstr("xvfb-run"));
  const test::ProgramRun dead =
      test::RunProgram(std::string("env DISPLAY=:4711 ") + SEXTANT_BINARY, "mark --cloud scan.pcd");
  EXPECT_EQ(dead.exit_code, 2);
  EXPECT_THAT(dead.err, HasSubstr("nothing answers on DISPLAY=:4711"));
}

TEST(Mark, RendersAPictureWithoutADisplay) {
  const Drawing drawing;
  WriteScan(drawing.scene);
  ScanMarks marks = drawing.projection;
  marks.boards = {drawing.board};
  test::WriteText(TestPath("polygons.yaml"), FormatPolygons(marks));
  const std::string files =
      "--cloud " + TestPath("scan.pcd") + " --out " + TestPath("polygons.yaml");
  const test::ProgramRun run = Mark(files + " --render " + TestPath("window.png"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const cv::Mat picture = test::ReadPicture(TestPath("window.png"));
  EXPECT_EQ(picture.size(), cv::Size(kWidth, kHeight));
  EXPECT_EQ(Mark(files + " --render window.bmp").exit_code, 2);
}

// The window's picture with these options.
cv::Mat WindowWith(const std::string& options) {
  const std::string files = "--cloud " + TestPath("scan.pcd") + " --out " + TestPath("none.yaml");
  const test::ProgramRun run = Mark(files + " --render " + TestPath("w.png") + " " + options);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return test::ReadPicture(TestPath("w.png"), DecodedColor::kGrey);
}

TEST(Mark, APoseIsReadFromNumbersFilesOrAYaw) {
  const Drawing drawing;
  WriteScan(drawing.scene);
  const Eigen::AngleAxisd turn(-0.25 * std::numbers::pi, Eigen::Vector3d::UnitZ());
  const Rigid3d pose = AxesCamFromLidar() * Rigid3d{Eigen::Quaterniond(turn), {0, 0, 0}};
  // To the left: a point ahead and left of the LiDAR is in the middle.
  EXPECT_LT((pose * Eigen::Vector3d(1.0, 1.0, 0.0)).head<2>().norm(), 1e-9);
  const Eigen::Quaterniond& q = pose.rotation;
  const std::string numbers =
      fmt::format("--cam-from-lidar 0 0 0 {} {} {} {}", q.w(), q.x(), q.y(), q.z());
  const Eigen::Matrix4d m = pose.Matrix();
  std::string rows;
  for (int i = 0; i < 4; ++i) {
    rows += fmt::format("{} {} {} {}\n", m(i, 0), m(i, 1), m(i, 2), m(i, 3));
  }
  test::WriteText(TestPath("rts.txt"), rows);
  SolveReport report;
  report.cam_from_lidar = pose;
  ResultFile results;
  results.results.push_back({"p3p", MakeError(ErrorCode::kDegenerate, "on a line")});
  results.results.push_back({"kabsch", report});
  test::WriteText(TestPath("results.json"), FormatResults(results));
  const cv::Mat expected = WindowWith(numbers);
  EXPECT_GT(cv::countNonZero(WindowWith("") != expected), 1000);
  for (const std::string& same :
       {std::string("--yaw 45"), "--cam-from-lidar " + TestPath("rts.txt"),
        "--cam-from-lidar " + TestPath("results.json")}) {
    EXPECT_EQ(cv::countNonZero(WindowWith(same) != expected), 0) << same;
  }
}

TEST(Mark, RefusesWhatItCannotUse) {
  const Drawing drawing;
  WriteScan(drawing.scene);
  const std::string scan = "--cloud " + TestPath("scan.pcd") + " --out " + TestPath("p.yaml") +
                           " --render " + TestPath("w.png") + " ";
  EXPECT_THAT(Mark(scan + "--image " + TestPath("scan.pcd")).err, HasSubstr("expected an image"));
  EXPECT_EQ(Mark(scan + "--cam-from-lidar a.json --yaw 5").exit_code, 2);
  EXPECT_THAT(Mark(scan + "--cam-from-lidar 0 0 0 1").err, HasSubstr("X Y Z QW QX QY QZ"));
  EXPECT_THAT(Mark(scan + "--cam-from-lidar 0 0 0 1 1 0 0").err, HasSubstr("length 1"));
  // The camera looks up.
  EXPECT_THAT(Mark(scan + "--cam-from-lidar 0 0 -9 1 0 0 0").err, HasSubstr("is in view"));
  ScanMarks other = drawing.projection;
  other.camera.fx_px = 500.0;
  test::WriteText(TestPath("p.yaml"), FormatPolygons(other));
  EXPECT_THAT(Mark(scan + "--cam-from-lidar 0 0 0 0.5 0.5 -0.5 0.5").err,
              HasSubstr("another projection"));
}

}  // namespace
}  // namespace sextant
