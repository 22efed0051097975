// SPDX-License-Identifier: Apache-2.0
#include "io/cameras/camera_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "io/cameras/camera_parts.h"
#include "io/text/line_reader.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

constexpr int kMaxColmapPixels = 1'000'000;  // Per side.
constexpr std::size_t kMaxNumbersOfName = 64;

// The parameters of a COLMAP model: one focal length or two, the centre, and coefficients in the
// order of `model`.
struct ColmapModel {
  std::string_view name;
  std::string_view model;
  bool one_focal;
  std::size_t coefficients;
};

constexpr std::array kColmapModels = {
    ColmapModel{"SIMPLE_PINHOLE", "", true, 0},
    ColmapModel{"PINHOLE", "", false, 0},
    ColmapModel{"SIMPLE_RADIAL", "plumb_bob", true, 1},
    ColmapModel{"RADIAL", "plumb_bob", true, 2},
    ColmapModel{"OPENCV", "plumb_bob", false, 4},
    ColmapModel{"FULL_OPENCV", "rational_polynomial", false, 8},
    ColmapModel{"OPENCV_FISHEYE", "equidistant", false, 4},
    ColmapModel{"SIMPLE_RADIAL_FISHEYE", "equidistant", true, 1},
    ColmapModel{"RADIAL_FISHEYE", "equidistant", true, 2},
    ColmapModel{"FOV", "FOV", false, 1},
    ColmapModel{"THIN_PRISM_FISHEYE", "THIN_PRISM_FISHEYE", false, 8}};

const ColmapModel* FindColmapModel(std::string_view name) {
  const auto* found = std::ranges::find(kColmapModels, name, &ColmapModel::name);
  return found == kColmapModels.end() ? nullptr : found;
}

// A line "1 OPENCV 1280 720 fx fy cx cy k1 k2 p1 p2"; `distortion` holds what the parts refer to.
CameraParts ReadColmapLine(LineReader& in, const ColmapModel& model,
                           std::vector<double>& distortion) {
  CameraParts parts;
  const std::size_t focals = model.one_focal ? 1 : 2;
  const std::size_t first = 4 + focals + 2;
  const std::size_t count = first + model.coefficients;
  if (!in.HasFields(count, fmt::format("{} values of the model {}", count, model.name))) {
    return parts;
  }
  parts.width_px = static_cast<int>(in.Integer(2, 1, kMaxColmapPixels, "width"));
  parts.height_px = static_cast<int>(in.Integer(3, 1, kMaxColmapPixels, "height"));
  constexpr double kFirstPixel = 0.5;
  const double fx = in.Real(4, "focal length");
  const double fy = model.one_focal ? fx : in.Real(5, "focal length");
  const double cx = in.Real(4 + focals, "centre") - kFirstPixel;
  const double cy = in.Real(5 + focals, "centre") - kFirstPixel;
  parts.matrix = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
  parts.model = model.model;
  distortion.clear();
  for (std::size_t i = 0; i < model.coefficients; ++i) {
    distortion.push_back(in.Real(first + i, "distortion"));
  }
  // Models with fewer coefficients than OpenCV's leave out the last ones.
  if (model.coefficients > 0 && model.coefficients < 4) distortion.resize(4, 0.0);
  parts.distortion = distortion;
  return parts;
}

bool IsNumber(std::string_view text) { return ParseFinite(text, {}).has_value(); }

bool IsName(std::string_view text) {
  return !text.empty() && !IsNumber(text.substr(0, 1)) &&
         std::ranges::all_of(text, [](unsigned char c) {
           return c == '_' || c == '.' || (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
                  (c >= 'a' && c <= 'z');
         });
}

std::string_view TrimBlanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

YamlNode MakeNode(YamlNode::Kind kind, int line, std::string_view text = {}) {
  YamlNode node;
  node.kind = kind;
  node.line = line;
  node.text = std::string(text);
  return node;
}

// The numbers of "[600 0 320; 0 600 240]", however they are separated and bracketed; none where
// there is anything else.
std::optional<YamlNode> NumbersOf(std::string_view text, int line) {
  YamlNode list = MakeNode(YamlNode::Kind::kSequence, line);
  constexpr std::string_view kMarks = "[](){},; \t\r\n";
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kMarks), text.size()));
    if (text.empty()) break;
    const std::string_view word = text.substr(0, text.find_first_of(kMarks));
    text.remove_prefix(word.size());
    // A function's name, as in np.array([...]).
    if (IsName(word) && text.starts_with('(')) continue;
    if (!IsNumber(word) || list.items.size() == kMaxNumbersOfName) return std::nullopt;
    list.items.push_back(MakeNode(YamlNode::Kind::kText, line, word));
  }
  return list;
}

// Removes comments, from '%' or '#' to the end of the line.
std::string WithoutComments(std::string_view text) {
  std::string plain;
  bool in_comment = false;
  for (const char c : text) {
    if (c == '\n') in_comment = false;
    if (c == '%' || c == '#') in_comment = true;
    if (!in_comment) plain += c;
  }
  return plain;
}

// The value after an assignment's sign, which ends with its brackets, or with its line.
std::string_view ValueIn(std::string_view rest) {
  const std::size_t first = std::min(rest.find_first_not_of(" \t"), rest.size());
  rest.remove_prefix(first);
  if (rest.substr(0, rest.find('\n')).find('[') == std::string_view::npos) {
    return rest.substr(0, rest.find_first_of("\n;"));
  }
  int depth = 0;
  for (std::size_t end = rest.find('['); end < rest.size(); ++end) {
    depth += rest[end] == '[' ? 1 : rest[end] == ']' ? -1 : 0;
    if (depth == 0) return rest.substr(0, end);
  }
  return rest;
}

// The name before an assignment's sign; Matlab's cameraParams.K is K.
std::string_view NameIn(std::string_view before) {
  const std::size_t end = before.find_last_of("\n;");
  std::string_view name =
      TrimBlanks(end == std::string_view::npos ? before : before.substr(end + 1));
  if (const std::size_t dot = name.rfind('.'); dot != std::string_view::npos) {
    name.remove_prefix(dot + 1);
  }
  return name;
}

// The assignments whose values are numbers; others are skipped. Null for a text without any.
YamlNode ReadAssignments(std::string_view text) {
  YamlNode map = MakeNode(YamlNode::Kind::kMap, 1);
  int line = 1;
  std::size_t counted = 0;
  for (std::size_t equals = text.find('=');
       equals != std::string_view::npos && map.keys.size() < kMaxNumbersOfName;
       equals = text.find('=', equals + 1)) {
    line += static_cast<int>(std::ranges::count(text.substr(counted, equals - counted), '\n'));
    counted = equals;
    const std::string_view name = NameIn(text.substr(0, equals));
    const std::optional<YamlNode> numbers = NumbersOf(ValueIn(text.substr(equals + 1)), line);
    if (!IsName(name) || !numbers || numbers->items.empty() || map.Find(name) != nullptr) continue;
    map.keys.emplace_back(name);
    map.items.push_back(numbers->items.size() == 1 ? numbers->items.front() : *numbers);
  }
  return map.keys.empty() ? YamlNode{} : map;
}

// Lines of numbers alone: three of three, and perhaps one of distortion coefficients.
std::optional<YamlNode> TreeOfNumbers(std::string_view text) {
  YamlNode matrix = MakeNode(YamlNode::Kind::kSequence, 1);
  YamlNode distortion = MakeNode(YamlNode::Kind::kSequence, 4);
  LineReader in("", text,
                text.find(',') == std::string_view::npos ? LineReader::Separator::kBlanks
                                                         : LineReader::Separator::kCommas);
  for (int row = 0; in.Next(); ++row) {
    if (row > 3 || (row < 3 && in.field_count() != 3)) return std::nullopt;
    for (std::size_t i = 0; i < in.field_count(); ++i) {
      if (!IsNumber(in.Field(i))) return std::nullopt;
      (row < 3 ? matrix : distortion)
          .items.push_back(MakeNode(YamlNode::Kind::kText, in.line(), in.Field(i)));
    }
  }
  if (matrix.items.size() != 9) return std::nullopt;
  YamlNode map = MakeNode(YamlNode::Kind::kMap, 1);
  map.keys.emplace_back("K");
  map.items.push_back(std::move(matrix));
  if (!distortion.items.empty()) {
    map.keys.emplace_back("D");
    map.items.push_back(std::move(distortion));
  }
  return map;
}

}  // namespace

std::optional<Expected<Camera>> ParseCameraColmap(std::string_view text, const std::string& file,
                                                  std::string_view name) {
  LineReader in(file, text);
  std::optional<Expected<Camera>> found;
  std::string names;
  while (in.Next()) {
    const ColmapModel* model = in.field_count() < 2 ? nullptr : FindColmapModel(in.Field(1));
    if (model == nullptr || !IsNumber(in.Field(0))) {
      if (names.empty()) return std::nullopt;
      in.Fail(ErrorCode::kParse, "expected a camera: its number, model, width, height, parameters");
      break;
    }
    const std::string id(in.Field(0));
    names += (names.empty() ? "" : ", ") + id;
    if (!name.empty() && id != name) continue;
    if (name.empty() && found) {
      found = MakeError(ErrorCode::kParse,
                        fmt::format("{}: the file holds several cameras: {}, ...; name one of "
                                    "them, as in {}:{}",
                                    file, names, file, id));
      return found;
    }
    std::vector<double> distortion;
    const CameraParts parts = ReadColmapLine(in, *model, distortion);
    if (!in.ok()) break;
    found = AtPlace(CameraFromParts(parts), {.file = file, .line = in.line()});
  }
  if (!in.ok()) return Expected<Camera>(in.TakeError());
  if (!found && !names.empty()) {
    found = MakeError(ErrorCode::kParse, fmt::format("{}: the file has no camera {}; it has {}",
                                                     file, Quoted(std::string(name)), names));
  }
  return found;
}

std::optional<YamlNode> TreeOfAssignments(std::string_view text) {
  constexpr std::size_t kMaxBytes = std::size_t{1} << 16;
  if (text.size() > kMaxBytes) return std::nullopt;
  if (std::optional<YamlNode> numbers = TreeOfNumbers(text)) return numbers;
  const std::string plain = WithoutComments(text);
  // The first words are a name and '='.
  const std::size_t equals = plain.find('=');
  if (equals == std::string::npos) return std::nullopt;
  const std::string_view first = TrimBlanks(std::string_view(plain).substr(0, equals));
  if (!IsName(first)) return std::nullopt;
  YamlNode map = ReadAssignments(plain);
  if (map.kind != YamlNode::Kind::kMap) return std::nullopt;
  return map;
}

}  // namespace sextant
