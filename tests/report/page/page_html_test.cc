// SPDX-License-Identifier: Apache-2.0
#include "report/page/page_html.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "report/page/assets.h"
#include "report/page/base64.h"
#include "report/page/plot_axis.h"
#include "support/hostile_text.h"
#include "support/some_page.h"

namespace sextant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// The page without the texts of its scripts and styles, which are ours.
std::string WithoutScripts(const std::string& html) {
  static const std::array<std::pair<std::string_view, std::string_view>, 2> kElements = {
      {{"<style>", "</style>"}, {"<script", "</script>"}}};
  std::string text = html;
  for (const auto& [begin, end] : kElements) {
    std::string kept;
    for (std::size_t at = 0;;) {
      const std::size_t first = text.find(begin, at);
      kept += text.substr(at, first == std::string::npos ? first : first - at);
      if (first == std::string::npos) break;
      at = text.find(end, first) + end.size();
    }
    text = kept;
  }
  return text;
}

// Every tag with the names of its attributes: "td class", "/td".
std::vector<std::string> Skeleton(const std::string& html) {
  std::vector<std::string> tags;
  const std::string text = WithoutScripts(html);
  for (std::size_t i = text.find('<'); i != std::string::npos; i = text.find('<', i)) {
    std::string tag;
    bool is_quoted = false;
    for (++i; i < text.size() && (is_quoted || text[i] != '>'); ++i) {
      if (text[i] == '"') is_quoted = !is_quoted;
      if (!is_quoted && text[i] != '"') tag += text[i];
    }
    tags.push_back(tag);
  }
  return tags;
}

std::string NameOfTag(const std::string& tag) { return tag.substr(0, tag.find_first_of(" /", 1)); }

TEST(PageHtml, EveryTagIsClosed) {
  const std::vector<std::string> empty = {"meta", "img", "input", "!DOCTYPE"};
  std::vector<std::string> open;
  for (const std::string& tag : Skeleton(FormatPage(test::SomePage(3, "text", "jpeg")))) {
    const std::string name = NameOfTag(tag);
    if (tag.ends_with('/') || std::ranges::count(empty, name) > 0) continue;
    if (tag[0] != '/') {
      open.push_back(name);
      continue;
    }
    ASSERT_FALSE(open.empty()) << tag;
    EXPECT_EQ("/" + open.back(), tag);
    open.pop_back();
  }
  EXPECT_THAT(open, ElementsAre());
}

// Whatever a file's texts are, they add no tag and no attribute.
TEST(PageHtml, HostileTextsStayText) {
  const std::vector<std::string> plain = Skeleton(FormatPage(test::SomePage(2, "text", "jpeg")));
  for (const std::string& text : test::HostileTexts()) {
    if (text.empty()) continue;  // Parts without a text are omitted.
    const std::string html = FormatPage(test::SomePage(2, text, "jpeg"));
    EXPECT_EQ(Skeleton(html), plain) << text.substr(0, 60);
    EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  }
}

std::string SceneOf(const std::string& html) {
  constexpr std::string_view kBegin = "<script type=\"application/json\" id=\"scene\">";
  const std::size_t at = html.find(kBegin) + kBegin.size();
  return html.substr(at, html.find("</script>", at) - at);
}

TEST(PageHtml, TheSceneIsJsonWithTheTextsAsTheyAre) {
  const std::string text = "</script><script>alert(1)</script><!--";
  const auto scene = nlohmann::json::parse(SceneOf(FormatPage(test::SomePage(3, text, "jpeg"))));
  ASSERT_EQ(scene["views"].size(), 3U);
  EXPECT_EQ(scene["views"][0]["name"], text);
  EXPECT_EQ(scene["views"][0]["scan"]["count"], 400);
  EXPECT_EQ(scene["views"][0]["boards"][0]["camera"].size(), 12U);
  EXPECT_EQ(scene["views"][2]["kept"], false);
  EXPECT_EQ(scene["sensors"].size(), 2U);
}

// The same content gives the same bytes, and nothing is loaded from elsewhere.
TEST(PageHtml, IsReproducibleAndWhole) {
  const ReportPage page = test::SomePage(3, "text", "jpeg");
  const std::string html = FormatPage(page);
  EXPECT_EQ(html, FormatPage(page));
  const std::string own = WithoutScripts(html);
  static const std::regex link(R"re((src|href)="(?!data:|#))re");
  EXPECT_FALSE(std::regex_search(own, link));
  EXPECT_THAT(std::string(PageStyle()), Not(HasSubstr("url(")));
  EXPECT_THAT(std::string(PageStyle()), Not(HasSubstr("@import")));
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
}

// Tables and pictures are in the page before any script runs.
TEST(PageHtml, NeedsNoJavaScriptForItsTables) {
  const std::string html = WithoutScripts(FormatPage(test::SomePage(3, "a text", "jpeg")));
  for (const char* part :
       {"id=\"view-0\"", "id=\"view-2\"", "data:image/jpeg;base64,anBlZw==", "class=\"top-view\"",
        "class=\"scan\"", "class=\"by-camera\"", "class=\"by-lidar\"", "class=\"heat\"",
        "left out</b>: a text", "<td>1 right</td><td class=\"n\">2.0</td><td class=\"n\">0.20</td>",
        "id=\"uncertainty\"", "id=\"solvers\"", "id=\"next\"", "id=\"inputs\"",
        "a text_from_a text", "0.10000000\n"}) {
    EXPECT_THAT(html, HasSubstr(part)) << part;
  }
}

TEST(PageHtml, StatesTheVerdictInWordsAndMarks) {
  ReportPage page = test::SomePage(1, "text", "jpeg");
  page.verdict = {PageTone::kBad, "NOT USABLE", "one view", "add views"};
  EXPECT_THAT(FormatPage(page), HasSubstr("class=\"verdict bad\""));
  EXPECT_THAT(FormatPage(page), HasSubstr("<strong>NOT USABLE</strong>\n<p>one view.</p>"));
}

ReportPage LivePage(const std::string& text) {
  ReportPage page = test::SomePage(2, text, "jpeg");
  page.selected = 1;
  page.live = PageLive{.revision = text, .state = text, .found = {text, text}};
  page.sections = {{"own", text, text, {text}, {.header = {text}, .rows = {{text}}}}};
  return page;
}

TEST(PageHtml, ACaptureShowsTheNextPlacementFirstAndAsksItsServerAlone) {
  ReportPage page = LivePage("text");
  page.live->state = "Waiting for the next photo";
  page.live->revision = "r-7";
  const std::string html = FormatPage(page);
  const std::string own = WithoutScripts(html);
  EXPECT_LT(own.find("Hold the board here next"), own.find("id=\"diagnostics\""));
  EXPECT_THAT(own, Not(HasSubstr("id=\"next\"")));
  EXPECT_THAT(own, HasSubstr("Waiting for the next photo"));
  EXPECT_THAT(own, HasSubstr("data-revision=\"r-7\""));
  EXPECT_THAT(own, HasSubstr("connect-src 'self'"));
  EXPECT_THAT(own, HasSubstr("http-equiv=\"refresh\""));
  EXPECT_EQ(nlohmann::json::parse(SceneOf(html))["selected"], 1);
  EXPECT_THAT(html, HasSubstr(std::string(LiveScript())));

  page.live->has_ended = true;
  const std::string last = FormatPage(page);
  EXPECT_THAT(last, Not(HasSubstr(std::string(LiveScript()))));
  EXPECT_THAT(last, Not(HasSubstr("http-equiv=\"refresh\"")));
  EXPECT_THAT(FormatPage(test::SomePage(2, "text", "jpeg")), Not(HasSubstr("connect-src")));
}

TEST(PageHtml, HostileTextsStayTextInACaptureAndInOwnSections) {
  const std::vector<std::string> plain = Skeleton(FormatPage(LivePage("text")));
  for (const std::string& text : test::HostileTexts()) {
    if (text.empty()) continue;
    EXPECT_EQ(Skeleton(FormatPage(LivePage(text))), plain) << text.substr(0, 60);
  }
}

TEST(PageHtml, PartsWithoutContentAreLeftOut) {
  const std::string html = FormatPage({.title = "a rig", .diagnostics = {"a line"}});
  for (const char* part : {"id=\"views\"", "id=\"residuals\"", "id=\"solvers\"", "#views"}) {
    EXPECT_THAT(html, Not(HasSubstr(part))) << part;
  }
}

TEST(PageHtml, ManagesWithoutViewsSensorsAndFigures) {
  const std::string html = FormatPage(ReportPage{.title = "empty"});
  EXPECT_THAT(html, HasSubstr("<h1>empty</h1>"));
  EXPECT_THAT(html, HasSubstr("</html>"));
}

TEST(PageHtml, OurScriptsCannotEndTheirElement) {
  for (const std::string_view script : {PageScript(), LiveScript(), SceneScript(), ThreeScript()}) {
    EXPECT_EQ(script.find("</script"), std::string_view::npos);
    EXPECT_EQ(script.find("<!--"), std::string_view::npos);
  }
  EXPECT_THAT(std::string(ThreeLicence()), HasSubstr("Permission is hereby granted"));
}

TEST(Base64, AgreesWithRfc4648) {
  const std::array<std::pair<const char*, const char*>, 7> cases = {{{"", ""},
                                                                     {"f", "Zg=="},
                                                                     {"fo", "Zm8="},
                                                                     {"foo", "Zm9v"},
                                                                     {"foob", "Zm9vYg=="},
                                                                     {"fooba", "Zm9vYmE="},
                                                                     {"foobar", "Zm9vYmFy"}}};
  for (const auto& [bytes, text] : cases) EXPECT_EQ(Base64(bytes), text);
  EXPECT_EQ(Base64("\xff\xfe\xfd"), "//79");
}

TEST(PlotAxis, HasRoundTicksAroundTheData) {
  EXPECT_THAT(PlotAxis({0.3, 9.1}, false).ticks(), ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(PlotAxis({98.0, 101.0}, false).ticks(),
              ElementsAre(98, 98.5, 99, 99.5, 100, 100.5, 101));
  EXPECT_THAT(PlotAxis({1.5, 40.0}, true).ticks(), ElementsAre(1, 2, 5, 10, 20, 50));
  EXPECT_THAT(PlotAxis({0.02, 30.0}, true).ticks(), ElementsAre(0.01, 0.1, 1, 10, 100));
  for (const double value : {0.0, 5.0, -3.0, 1e-12}) {
    const PlotAxis axis({value}, false);
    EXPECT_GE(axis.Share(value), 0.0);
    EXPECT_LE(axis.Share(value), 1.0);
    EXPECT_GE(axis.ticks().size(), 2U);
  }
}

}  // namespace
}  // namespace sextant
