// SPDX-License-Identifier: Apache-2.0
#include "report/gnuplot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <filesystem>
#include <sstream>
#include <string>

#include "base/text/code_point.h"
#include "base/text/escape.h"
#include "support/hostile_text.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::Not;

// Throws if the text is not well-formed.
boost::property_tree::ptree ReadXml(const std::string& text) {
  std::istringstream stream(text);
  boost::property_tree::ptree tree;
  boost::property_tree::read_xml(stream, tree);
  return tree;
}

// Every text as the title, a label, a tick and a line's title of one plot.
std::string HostilePlot() {
  std::string commands = "set key noenhanced\n";
  std::string lines;
  for (const std::string& text : test::HostileTexts()) {
    if (text.size() > 2000) continue;
    const std::string quoted = GnuplotText(text);
    commands += "set title " + quoted + " noenhanced\nset xlabel " + quoted + " noenhanced\n";
    lines += (lines.empty() ? "" : ", ") + std::string("x title ") + quoted;
  }
  return commands + "plot " + lines + "\n";
}

// The test's folder is the working folder, where a command of a text would leave its file.
class Gnuplot : public testing::Test {
 protected:
  Gnuplot() : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(test::TestFolder());
  }
  ~Gnuplot() override {
    EXPECT_TRUE(std::filesystem::is_empty(test::TestFolder())) << "a text was run as a command";
    std::filesystem::current_path(before_);
  }

 private:
  std::filesystem::path before_;
};

TEST_F(Gnuplot, DrawsHostileTextsAsText) {
  const Expected<std::string> svg = RunGnuplot(HostilePlot(), PlotFormat::kSvg);
  ASSERT_TRUE(svg) << svg.error().message;
  EXPECT_NO_THROW(ReadXml(*svg));
  std::string line = *svg;
  std::erase_if(line, [](char c) { return c == '\n' || c == '\t'; });
  EXPECT_TRUE(IsPlainLine(line));
  EXPECT_THAT(*svg, HasSubstr("S\\x0a!touch owned\\x0a#"));
  EXPECT_THAT(*svg, HasSubstr("&lt;script>alert(1)"));
  EXPECT_THAT(*svg, Not(HasSubstr("]]>")));
  EXPECT_TRUE(RunGnuplot(HostilePlot(), PlotFormat::kPng));
}

TEST_F(Gnuplot, ItsOwnMessageIsReported) {
  const Expected<std::string> failed = RunGnuplot("plot no_such_variable\n", PlotFormat::kSvg);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kIo);
  EXPECT_THAT(failed.error().message, HasSubstr("undefined variable: no_such_variable"));
}

TEST_F(Gnuplot, AnIncompletePictureIsRefused) {
  const Expected<std::string> nothing = RunGnuplot("set xrange [0:1]\n", PlotFormat::kPng);
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().message, HasSubstr("0 bytes of a picture"));
}

}  // namespace
}  // namespace sextant
