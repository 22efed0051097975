// SPDX-License-Identifier: Apache-2.0
// A capture as a user has it: files appear one after the other, and the page is read meanwhile.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "e2e/run_sextant.h"
#include "e2e/shared_session.h"
#include "e2e/swinging_scene.h"
#include "io/results/calibration_result.h"
#include "support/display/browser.h"
#include "support/display/http_get.h"
#include "support/display/virtual_display.h"
#include "support/run_program.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

using test::Eventually;
using test::HttpGet;
using test::ReadText;
using test::TestFolder;
using test::TestPath;
using test::WriteText;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kCameraToCapture = R"(  - name: cam
    intrinsics: {model: pinhole, width_px: 960, height_px: 600, fx_px: 560, fy_px: 560, cx_px: 479.5, cy_px: 299.5}
    pose: {position_m: [0.05, 0.1, 0.92], yaw_deg: 2, pitch_deg: 1, roll_deg: -1}
)";
// More than any machine needs; nothing is measured by it.
constexpr double kPatience_s = 300.0;

fs::path Recording() {
  return test::SharedSession(test::SwingingScene("capture", kCameraToCapture),
                             "--interval 60 --scans 6");
}

std::string NameOf(const std::string& kind, int view) {
  return kind + "_00" + std::to_string(view) + (kind == "cam" ? ".png" : ".pcd");
}

/// A capture that runs, with the boards and the camera of the recording, but no photo and no scan.
class CaptureRun : public testing::Test {
 protected:
  void SetUp() override {
    recording_ = Recording();
    fs::create_directories(folder_);
    for (const char* name : {"boards.yaml", "cam_info.yaml"}) Copy(name);
  }

  void Start(const std::string& need) {
    log_ = TestPath("log");
    program_ = std::make_unique<test::BackgroundProgram>(
        std::vector<std::string>{SEXTANT_BINARY, "capture", folder_.string(), "--port", "0",
                                 "--need", need, "--out", TestPath("result.yaml"), "--report",
                                 TestPath("report.html"), "--bootstrap", "20"},
        std::vector<std::string>{}, log_);
    ASSERT_TRUE(Eventually(kPatience_s, [&] { return Port() != 0; })) << ReadText(log_);
  }

  std::uint16_t Port() const {
    const std::string text = ReadText(log_);
    const std::string before = "http://127.0.0.1:";
    const std::size_t at = text.find(before);
    if (at == std::string::npos || text.find('\n', at) == std::string::npos) return 0;
    return static_cast<std::uint16_t>(std::stoi(text.substr(at + before.size())));
  }

  void Copy(const std::string& name) const {
    fs::copy_file(recording_ / name, folder_ / name, fs::copy_options::overwrite_existing);
  }

  void Drop(int view) const {
    Copy(NameOf("cam", view));
    Copy(NameOf("scan", view));
  }

  bool PageHas(const std::string& text) const {
    return HttpGet(Port(), "/").body.find(text) != std::string::npos;
  }

  fs::path recording_;
  fs::path folder_ = TestFolder() / "watched";
  std::string log_;
  std::unique_ptr<test::BackgroundProgram> program_;
};

TEST_F(CaptureRun, FilesThatAppearAreProcessedUntilTheAccuracyIsReached) {
  Start("60,2");
  EXPECT_TRUE(Eventually(kPatience_s, [&] { return PageHas("NOTHING YET"); }));
  EXPECT_TRUE(PageHas("1.2 to 3 m away"));

  // A scan of which half is written is not taken for a scan.
  Copy(NameOf("cam", 0));
  const std::string scan = ReadText(recording_ / NameOf("scan", 0));
  WriteText(folder_ / NameOf("scan", 0), scan.substr(0, scan.size() / 2));
  EXPECT_TRUE(Eventually(kPatience_s, [&] { return PageHas("<li>000: "); })) << ReadText(log_);
  EXPECT_FALSE(PageHas("<li>000: boards"));
  Copy(NameOf("scan", 0));
  EXPECT_TRUE(Eventually(kPatience_s, [&] {
    return PageHas("<li>000: boards 0, 1 in the photo; ");
  })) << ReadText(log_);

  // A photo alone waits for its scan.
  Copy(NameOf("cam", 1));
  EXPECT_TRUE(Eventually(kPatience_s, [&] {
    return HttpGet(Port(), "/state").body.find("Without a partner: cam_001.png") !=
           std::string::npos;
  }));
  Copy(NameOf("scan", 1));
  EXPECT_TRUE(Eventually(kPatience_s, [&] { return PageHas("<li>001: "); })) << ReadText(log_);
  EXPECT_TRUE(PageHas("Hold board"));  // By advise: there is a pose.
  EXPECT_FALSE(fs::exists(TestPath("result.yaml")));

  for (int view = 2; view < 6 && !fs::exists(TestPath("result.yaml")); ++view) {
    Drop(view);
    const std::string line = "\n00" + std::to_string(view) + ": ";
    // An answer without this view may have been good enough.
    EXPECT_TRUE(Eventually(kPatience_s, [&] {
      const std::string log = ReadText(log_);
      const std::size_t at = log.find(line);
      const bool is_answered = at != std::string::npos && log.find("known to", at) != log.npos;
      return is_answered || fs::exists(TestPath("result.yaml"));
    })) << ReadText(log_);
  }
  EXPECT_EQ(program_->Wait(kPatience_s), 0) << ReadText(log_);
  EXPECT_THAT(ReadText(log_), HasSubstr("GOOD: "));
  EXPECT_THAT(ReadText(log_), HasSubstr("report.html: the report"));
  const auto result = ReadCalibrationResult(TestPath("result.yaml"));
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->verdict->usability, Usability::kGood);
  EXPECT_GE(result->views.size(), 4U);
  EXPECT_THAT(ReadText(TestPath("report.html")), HasSubstr("Calibration report"));
  EXPECT_THAT(ReadText(TestPath("report.html")), Not(HasSubstr("live-state")));
}

TEST_F(CaptureRun, ItGoesOnWithTheFilesThatAreThereAndGivesTheAnswerOfCalibrate) {
  for (int view = 0; view < 6; ++view) Drop(view);
  Start("60,2");
  EXPECT_EQ(program_->Wait(kPatience_s), 0) << ReadText(log_);
  const test::ProgramRun run = test::RunSextant(
      "calibrate --image '" + (folder_ / "cam_*.png").string() + "' --cloud '" +
      (folder_ / "scan_*.pcd").string() + "' --board " + (folder_ / "boards.yaml").string() +
      " --camera " + (folder_ / "cam_info.yaml").string() + " --need 60,2 --bootstrap 20 --out " +
      TestPath("calibrated.yaml"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(ReadText(TestPath("result.yaml")), ReadText(TestPath("calibrated.yaml")));
}

TEST_F(CaptureRun, StandardOutputHasTheJsonAlone) {
  for (int view = 0; view < 6; ++view) Drop(view);
  const test::ProgramRun run = test::RunSextant(
      "capture " + folder_.string() + " --port 0 --need 60,2 --bootstrap 20 --json - --out " +
      TestPath("result.yaml") + " --report " + TestPath("report.html"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, testing::StartsWith("{"));
  EXPECT_THAT(run.out, Not(HasSubstr("Watching")));
  EXPECT_THAT(run.err, HasSubstr("Watching '"));
  EXPECT_THAT(run.err, HasSubstr("known to"));
}

// What the page shows in a browser, where there is one, before and after the first views.
TEST_F(CaptureRun, CtrlCWritesWhatIsKnownAndThePageShowsItBefore) {
  const bool has_browser = test::Browser::IsInstalled();
  const test::Browser browser(TestFolder() / "profile");
  Start("0.001,0.001");
  const std::string address = "http://127.0.0.1:" + std::to_string(Port()) + "/";
  if (has_browser) {
    const test::Browser::Page page = browser.LoadAddress(address);
    EXPECT_EQ(page.console, "");
    EXPECT_THAT(page.dom, HasSubstr("Waiting for the"));
  }
  Drop(0);
  Drop(1);
  EXPECT_TRUE(Eventually(kPatience_s, [&] {
    return ReadText(log_).find("known to") != std::string::npos && PageHas("<li>001: ");
  })) << ReadText(log_);
  if (has_browser) {
    const test::Browser::Page page = browser.LoadAddress(address);
    EXPECT_EQ(page.console, "");
    EXPECT_THAT(page.dom, HasSubstr("Hold the board here next"));
    EXPECT_THAT(page.dom, HasSubstr("class=\"selected\""));
    // What scripts may load is this server's state alone.
    EXPECT_THAT(page.dom, HasSubstr("connect-src 'self'"));
  }
  program_->Interrupt();
  const int code = program_->Wait(kPatience_s);
  const auto result = ReadCalibrationResult(TestPath("result.yaml"));
  ASSERT_TRUE(result) << result.error().message << ReadText(log_);
  EXPECT_EQ(code, result->verdict->usability == Usability::kNotUsable ? 3 : 0);
  EXPECT_THAT(ReadText(TestPath("report.html")), HasSubstr("Calibration report"));
  if (!has_browser) GTEST_SKIP() << test::Browser::kAbsent;
}

TEST_F(CaptureRun, CtrlCWithoutAPairIsNoAnswer) {
  Start("10,0.1");
  Copy(NameOf("cam", 0));
  program_->Interrupt();
  EXPECT_EQ(program_->Wait(kPatience_s), 1);
  EXPECT_THAT(ReadText(log_), HasSubstr("no photo and scan of one moment appeared"));
  EXPECT_FALSE(fs::exists(TestPath("result.yaml")));
}

TEST_F(CaptureRun, FilesThatAreGoneAreNotSaidNeverToHaveAppeared) {
  Start("1,0.01");
  Drop(0);
  EXPECT_TRUE(Eventually(kPatience_s, [&] { return PageHas("<li>000: boards"); }));
  for (const char* kind : {"cam", "scan"}) fs::remove(folder_ / NameOf(kind, 0));
  EXPECT_TRUE(Eventually(kPatience_s, [&] { return PageHas("NOTHING YET"); }));
  program_->Interrupt();
  EXPECT_EQ(program_->Wait(kPatience_s), 1);
  EXPECT_THAT(ReadText(log_), HasSubstr("are gone, and the answer with them"));
}

TEST(CaptureCommand, WhatIsMissingIsNamedBeforeItWaits) {
  fs::create_directories(TestPath("empty"));
  test::ExpectRefused(test::RunSextant("capture " + TestPath("empty")), "--board is missing");
  test::ExpectRefused(test::RunSextant("capture " + TestPath("nowhere") + " --board b.yaml"),
                      "cannot read the folder");
}

TEST(CaptureCommand, AnOutputIsNoPhotoOrScanOfTheFolder) {
  const fs::path folder = TestFolder() / "watched";
  fs::create_directories(folder / "scans");
  WriteText(folder / "cam_000.png", "a photo");
  const std::string command = "capture " + folder.string() + " --overwrite ";
  test::ExpectRefused(test::RunSextant(command + "--out " + (folder / "cam_000.png").string()),
                      "--out: cannot write");
  // Such a file would be taken for a scan at the next start.
  test::ExpectRefused(test::RunSextant(command + "--json " + (folder / "scans/new.pcd").string()),
                      "it is taken for a photo or a scan");
  EXPECT_EQ(ReadText(folder / "cam_000.png"), "a photo");
  test::ExpectRefused(test::RunSextant(command + "--out " + (folder / "result.yaml").string()),
                      "--board is missing");
}

}  // namespace
}  // namespace sextant
