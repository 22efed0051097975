// SPDX-License-Identifier: Apache-2.0
#include "io/problems/csv_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "base/nearest_name.h"
#include "base/text/lower_case.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

using Names = std::vector<std::string>;

const Names& KnownColumns() {
  static const Names kNames = {"u",       "v",    "x",      "y",      "z",      "camx",
                               "camy",    "camz", "lidarx", "lidary", "lidarz", "sigma_px",
                               "sigma_m", "id",   "view",   "board",  "corner"};
  return kNames;
}

// Names of other programs, as Plain writes them.
const std::map<std::string, std::string, std::less<>>& OtherNames() {
  static const auto kNames = [] {
    std::map<std::string, std::string, std::less<>> names = {{"col", "u"},
                                                             {"column", "u"},
                                                             {"row", "v"},
                                                             {"sigmapx", "sigma_px"},
                                                             {"sigmam", "sigma_m"}};
    const std::map<std::string, std::string> groups = {
        {"pixel", "p"},     {"px", "p"},       {"p", "p"},         {"image", "p"},
        {"img", "p"},       {"cam", "cam"},    {"camera", "cam"},  {"lidar", "lidar"},
        {"laser", "lidar"}, {"velo", "lidar"}, {"world", "lidar"}, {"obj", "lidar"},
        {"object", "lidar"}};
    for (const auto& [word, group] : groups) {
      for (const char* axis : {"x", "y", "z"}) {
        const std::string pixel = *axis == 'x' ? "u" : "v";
        if (group == "p" && *axis == 'z') continue;
        const std::string known = group == "p" ? pixel : group + axis;
        names.emplace(word + axis, known);
        names.emplace(axis + word, known);
        if (group == "p") names.emplace(word + pixel, known);
        if (group == "p") names.emplace(pixel + word, known);
      }
    }
    return names;
  }();
  return kNames;
}

// Without quotes, blanks, underscores and a unit in brackets.
std::string Plain(std::string_view name) {
  std::string plain;
  for (const char c : name.substr(0, name.find_first_of("[("))) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) plain.push_back(c);
  }
  return plain;
}

std::string KnownName(const std::string& plain, bool small_are_pixels) {
  if (small_are_pixels && plain == "x") return "u";
  if (small_are_pixels && plain == "y") return "v";
  const std::string lower = LowerCase(plain);
  const Names& known = KnownColumns();
  if (std::find(known.begin(), known.end(), lower) != known.end()) return lower;
  const auto other = OtherNames().find(lower);
  return other == OtherNames().end() ? std::string() : other->second;
}

bool AreNumbers(const LineReader& in) {
  for (std::size_t i = 0; i < in.field_count(); ++i) {
    if (!ParseFinite(in.Field(i), {})) return false;
  }
  return true;
}

CsvHeader HeaderOfNumbers(LineReader& in) {
  constexpr double kLargeAsPixels = 50.0;
  const auto is_large = [&](std::size_t i) { return std::abs(in.Real(i)) >= kLargeAsPixels; };
  CsvHeader header{.columns = {}, .has_names = false, .notes = {}};
  if (in.field_count() == 6) {
    header.columns = {"camx", "camy", "camz", "lidarx", "lidary", "lidarz"};
  } else if (in.field_count() == 5) {
    const bool pixels_last = !is_large(0) && !is_large(1) && is_large(3) && is_large(4);
    header.columns = pixels_last ? Names{"x", "y", "z", "u", "v"} : Names{"u", "v", "x", "y", "z"};
  } else {
    in.Fail(ErrorCode::kParse,
            fmt::format("{} numbers and no names of columns; expected a header line such as "
                        "u,v,x,y,z, or five or six numbers",
                        in.field_count()));
  }
  header.notes.push_back(fmt::format("columns: the file does not name them; taken as {}",
                                     fmt::join(header.columns, ",")));
  return header;
}

void AddColumn(LineReader& in, std::string_view name, std::string known, CsvHeader& header) {
  if (known.empty()) {
    const std::string lower = LowerCase(std::string(name));
    if (!NearestName(lower, KnownColumns()).empty()) {
      in.Fail(ErrorCode::kParse, fmt::format("unknown column {}; {}", Quoted(name),
                                             SuggestName(lower, KnownColumns())));
    }
    header.notes.push_back(fmt::format("columns: {} is not used", Quoted(name)));
    known = std::string(name);
  }
  if (std::find(header.columns.begin(), header.columns.end(), known) != header.columns.end()) {
    in.Fail(ErrorCode::kParse, fmt::format("the column {} appears twice", Quoted(known)));
  }
  header.columns.push_back(std::move(known));
}

// The LiDAR's points are x, y, z next to pixels.
void NamePointsBesidePixels(CsvHeader& header) {
  const auto has = [&](const char* name) {
    return std::find(header.columns.begin(), header.columns.end(), name) != header.columns.end();
  };
  if (!has("u") || !has("v") || has("x") || has("y") || has("z") || has("camx")) return;
  for (std::string& name : header.columns) {
    if (name == "lidarx" || name == "lidary" || name == "lidarz") name = name.substr(5);
  }
}

}  // namespace

CsvText::CsvText(std::string_view text) : text_(text) {
  LineReader lines({}, text);
  if (!lines.Next()) return;
  const auto has = [&](char mark) {
    for (std::size_t i = 0; i < lines.field_count(); ++i) {
      if (lines.Field(i).find(mark) != std::string_view::npos) return true;
    }
    return false;
  };
  if (has(';')) {
    separator_ = LineReader::Separator::kSemicolons;
    if (text.find(',') == std::string_view::npos) return;
    copy_ = text;
    std::replace(copy_.begin(), copy_.end(), ',', '.');
  } else if (has(',')) {
    separator_ = LineReader::Separator::kCommas;
  }
}

CsvHeader ReadCsvHeader(LineReader& in) {
  if (in.field_count() == 1 && AreNumbers(in)) in.Next();
  if (AreNumbers(in)) return HeaderOfNumbers(in);
  Names plain;
  for (std::size_t i = 0; i < in.field_count(); ++i) plain.push_back(Plain(in.Field(i)));
  const auto has = [&](const char* name) {
    return std::find(plain.begin(), plain.end(), name) != plain.end();
  };
  const bool small_are_pixels = has("x") && has("y") && has("X") && has("Y") && has("Z");
  CsvHeader header;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    AddColumn(in, in.Field(i), KnownName(plain[i], small_are_pixels), header);
  }
  NamePointsBesidePixels(header);
  return header;
}

}  // namespace sextant
