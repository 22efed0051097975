// SPDX-License-Identifier: Apache-2.0
#include "report/gnuplot.h"

#include <fmt/core.h>

#include <string_view>

#include "base/process/run_process.h"
#include "base/text/printable.h"

namespace sextant {
namespace {

const char* TerminalOf(PlotFormat format) {
  switch (format) {
    case PlotFormat::kSvg:
      return "set terminal svg size 960,480 background 'white' font 'sans,13'\n";
    case PlotFormat::kPng:
      return "set terminal pngcairo size 960,480 font 'sans,11'\n";
    case PlotFormat::kPdf:
      return "set terminal pdfcairo size 8in,4in font 'sans,11'\n";
  }
  return "";
}

// Warnings come first; the reason of a failure is last.
std::string LastLine(std::string_view text) {
  const std::size_t end = text.find_last_not_of(" \n");
  if (end == std::string_view::npos) return "no message";
  text = text.substr(0, end + 1);
  const std::size_t begin = text.rfind('\n');
  if (begin != std::string_view::npos) text.remove_prefix(begin + 1);
  text.remove_prefix(text.find_first_not_of(' '));
  return Printable(text, 200);
}

bool IsWhole(std::string_view picture, PlotFormat format) {
  using namespace std::string_view_literals;
  if (format == PlotFormat::kSvg) {
    const std::size_t end = picture.find_last_not_of('\n');
    return picture.starts_with("<?xml") && picture.substr(0, end + 1).ends_with("</svg>");
  }
  if (format == PlotFormat::kPdf) {
    const std::size_t end = picture.find_last_not_of('\n');
    return picture.starts_with("%PDF-") && picture.substr(0, end + 1).ends_with("%%EOF");
  }
  return picture.starts_with("\x89PNG\r\n\x1a\n"sv) && picture.ends_with("IEND\xae\x42\x60\x82"sv);
}

// In XML text this ends a section that was not begun; gnuplot escapes < and & only.
void EscapeSectionEnds(std::string& svg) {
  constexpr std::string_view kEnd = "]]>";
  for (std::size_t at = svg.find(kEnd); at != std::string::npos; at = svg.find(kEnd, at)) {
    svg.replace(at, kEnd.size(), "]]&gt;");
  }
}

// The date of the drawing, in as many digits, so that all offsets in the file stay right.
void RemoveDates(std::string& pdf) {
  constexpr std::string_view kDate = "/CreationDate (D:";
  for (std::size_t at = pdf.find(kDate); at != std::string::npos; at = pdf.find(kDate, at)) {
    at += kDate.size();
    for (; at < pdf.size() && pdf[at] >= '0' && pdf[at] <= '9'; ++at) pdf[at] = '0';
  }
}

}  // namespace

Expected<std::string> RunGnuplot(const std::string& commands, PlotFormat format) {
  Expected<ProcessEnd> end = RunProcess(
      {"gnuplot", "--default-settings"},
      {.standard_input = fmt::format("set encoding utf8\n{}{}\n", TerminalOf(format), commands)});
  if (!end && end.error().code == ErrorCode::kMissingData) {
    return MakeError(ErrorCode::kMissingData,
                     "plots need gnuplot: install the package gnuplot-nox");
  }
  if (!end) return tl::unexpected<Error>(std::move(end.error()));
  if (end->exit_code != 0 || !IsWhole(end->out, format)) {
    return MakeError(ErrorCode::kIo,
                     fmt::format("gnuplot failed with exit code {} and {} bytes of a picture: {}",
                                 end->exit_code, end->out.size(), LastLine(end->err)));
  }
  if (format == PlotFormat::kSvg) EscapeSectionEnds(end->out);
  if (format == PlotFormat::kPdf) RemoveDates(end->out);
  return std::move(end->out);
}

}  // namespace sextant
