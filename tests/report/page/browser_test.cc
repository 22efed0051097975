// SPDX-License-Identifier: Apache-2.0
// The report in a real browser: what its scripts do, and what it looks like.
#include "support/display/browser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "io/images/image_codec.h"
#include "report/page/assets.h"
#include "report/page/page_html.h"
#include "support/run_program.h"
#include "support/some_page.h"

namespace sextant {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Acts as a reader would and writes what came of it into the page.
constexpr const char* kReader = R"js(<script>
(function () {
  var seen = {};
  function all(selector) { return Array.prototype.slice.call(document.querySelectorAll(selector)); }
  function shown(selector) { return all(selector).filter(function (e) { return e.offsetParent !== null; }).length; }
  function colours() {
    var canvas = document.querySelector('#stage canvas');
    var copy = document.createElement('canvas');
    copy.width = canvas.width;
    copy.height = canvas.height;
    var pen = copy.getContext('2d');
    pen.drawImage(canvas, 0, 0);
    var pixels = pen.getImageData(0, 0, copy.width, copy.height).data;
    var drawn = 0;
    for (var i = 0; i < pixels.length; i += 4) {
      if (Math.abs(pixels[i] - 0x12) + Math.abs(pixels[i + 1] - 0x18) + Math.abs(pixels[i + 2] - 0x1f) > 40) ++drawn;
    }
    return drawn / (pixels.length / 4);
  }
  function set(selector, value, event) {
    var element = document.querySelector(selector);
    element.value = value;
    element.dispatchEvent(new Event(event, {bubbles: true}));
  }
  function check(part, isOn) {
    var box = document.querySelector('[data-part="' + part + '"]');
    box.checked = isOn;
    box.dispatchEvent(new Event('change'));
  }
  seen.webgl = document.documentElement.classList.contains('gl');
  seen.cards = shown('.card');
  seen.first = document.querySelector('.card.selected').dataset.view;
  if (seen.webgl) {
    seen.drawn = colours();
    set('#colour', 'photo', 'change');
    seen.inPhotoColours = colours();
    set('#colour', 'range', 'change');
    check('scan', false);
    seen.withoutScan = colours();
    ['camera', 'lidar', 'others', 'frusta', 'axes'].forEach(function (part) { check(part, false); });
    seen.emptied = colours();
    ['scan', 'camera', 'lidar', 'others', 'frusta', 'axes'].forEach(function (part) { check(part, true); });
    set('#look', 'camera', 'change');
    seen.fromCamera = colours();
    set('#look', 'overview', 'change');
    document.getElementById('measure').click();
    var box = document.getElementById('stage').getBoundingClientRect();
    seen.measured = '';
    for (var y = 0.1; y < 0.95 && seen.measured.indexOf('Distance') < 0; y += 0.02) {
      for (var x = 0.1; x < 0.95 && seen.measured.indexOf('Distance') < 0; x += 0.1) {
        var at = {clientX: box.left + x * box.width, clientY: box.top + y * box.height, bubbles: true};
        var stage = document.getElementById('stage');
        stage.dispatchEvent(new PointerEvent('pointerdown', at));
        stage.dispatchEvent(new PointerEvent('pointerup', at));
        seen.measured = document.getElementById('stage-note').textContent;
      }
    }
    document.getElementById('measure').click();
  }
  all('tr[data-view]')[2].click();
  seen.afterClick = document.querySelector('.card.selected').dataset.view;
  seen.selectedRow = document.querySelector('tr.selected').dataset.view;
  if (seen.webgl) seen.moment = document.getElementById('moment').value;
  var slider = document.querySelector('.card.selected .opacity input');
  slider.value = 20;
  slider.dispatchEvent(new Event('input'));
  seen.opacity = getComputedStyle(document.querySelector('.card.selected .scan')).opacity;
  seen.output = document.querySelector('.card.selected output').textContent;
  seen.wide = document.documentElement.scrollWidth <= window.innerWidth;
  var out = document.createElement('pre');
  out.id = 'seen';
  out.textContent = 'SEEN' + JSON.stringify(seen) + 'END';
  document.body.appendChild(out);
})();
</script>)js";

std::string GreyJpeg() {
  const Expected<std::string> jpeg = EncodeImage(".jpg", cv::Mat(48, 64, CV_8UC3, {120, 120, 120}));
  return jpeg ? *jpeg : std::string();
}

class ReportInBrowser : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::Browser::IsInstalled()) GTEST_SKIP() << test::Browser::kAbsent;
  }
  std::filesystem::path folder_ = test::TestFolder();
  test::Browser browser_{folder_ / "profile"};
};

json ReadSeen(const std::string& dom) {
  const std::size_t at = dom.find("<pre id=\"seen\">SEEN");
  if (at == std::string::npos) return {};
  const std::size_t begin = dom.find('{', at);
  return json::parse(dom.substr(begin, dom.find("END", begin) - begin));
}

TEST_F(ReportInBrowser, ViewsAreSelectedAndTheSceneIsDrawn) {
  std::string html = FormatPage(test::SomePage(4, "view <1>", GreyJpeg()));
  html.insert(html.rfind("</body>"), kReader);
  test::WriteText(folder_ / "page.html", html);
  const test::Browser::Page page = browser_.Load(folder_ / "page.html");
  EXPECT_EQ(page.console, "");
  const json seen = ReadSeen(page.dom);
  ASSERT_FALSE(seen.empty()) << page.console;
  EXPECT_EQ(seen["cards"], 1);
  EXPECT_EQ(seen["first"], "0");
  EXPECT_EQ(seen["afterClick"], "2");
  EXPECT_EQ(seen["selectedRow"], "2");
  EXPECT_EQ(seen["opacity"], "0.2");
  EXPECT_EQ(seen["output"], "20 %");
  EXPECT_EQ(seen["wide"], true) << "the page is wider than the window";
  if (ThreeScript().empty())
    GTEST_SKIP() << "THREE.JS ABSENT: install libjs-three, configure again";
  ASSERT_EQ(seen["webgl"], true);
  EXPECT_EQ(seen["moment"], "2");
  EXPECT_GT(seen["drawn"], 0.01) << "the canvas is blank";
  EXPECT_LT(seen["withoutScan"], seen["drawn"]);
  EXPECT_LT(seen["emptied"], seen["withoutScan"]);
  EXPECT_GT(seen["inPhotoColours"], 0.01);
  EXPECT_GT(seen["fromCamera"], 0.01);
  EXPECT_THAT(seen["measured"].get<std::string>(), HasSubstr("Distance "));
}

// Share of the pixels for which the colour is near (b, g, r).
double ShareNear(const cv::Mat& image, const cv::Vec3b& colour) {
  int near = 0;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const auto& pixel = image.at<cv::Vec3b>(y, x);
      int off = 0;
      for (int k = 0; k < 3; ++k) off = std::max(off, std::abs(pixel[k] - colour[k]));
      near += off <= 6 ? 1 : 0;
    }
  }
  return static_cast<double>(near) / static_cast<double>(image.total());
}

// Fonts differ between machines, so only the large parts are compared: paper, verdict, 3D view.
TEST_F(ReportInBrowser, LooksAsItShould) {
  test::WriteText(folder_ / "page.html", FormatPage(test::SomePage(4, "a text", GreyJpeg())));
  // A narrow page is longer: its photo is below the 3D view.
  for (const auto& [width, height] : {std::pair{1280, 2600}, std::pair{500, 3600}}) {
    browser_.Shoot(folder_ / "page.html", width, height, folder_ / "shot.png");
    const Expected<cv::Mat> shot =
        DecodeImage(test::ReadText(folder_ / "shot.png"), DecodedColor::kBgr);
    ASSERT_TRUE(shot) << shot.error().message;
    EXPECT_EQ(shot->size(), cv::Size(width, height));
    const double paper = ShareNear(*shot, {255, 255, 255});
    EXPECT_GT(paper, 0.5) << width;
    EXPECT_LT(paper, 0.97) << width;
    EXPECT_GT(ShareNear(*shot, {241, 246, 234}), 0.01) << "the verdict is not green at " << width;
    EXPECT_GT(ShareNear(*shot, {120, 120, 120}), 0.01) << "there is no photo at " << width;
    if (!ThreeScript().empty()) {
      EXPECT_GT(ShareNear(*shot, {0x1f, 0x18, 0x12}), 0.03) << "there is no 3D view at " << width;
    }
  }
}

}  // namespace
}  // namespace sextant
