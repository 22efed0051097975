// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "geometry/so3.h"
#include "io/poses/pose_parts.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxPoseXmlBytes = std::size_t{1} << 20;

std::vector<std::string> Words(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    const bool separates = std::isspace(static_cast<unsigned char>(c)) != 0 ||
                           std::string_view(",'\"[]()=").find(c) != std::string_view::npos;
    if (!separates) {
      words.back() += c;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::array<double, 4> QuaternionOf(double yaw, double pitch, double roll) {
  const Eigen::Quaterniond q = FromEulerZyx({.yaw = yaw, .pitch = pitch, .roll = roll});
  return {q.w(), q.x(), q.y(), q.z()};
}

// "--x 1 --yaw 0.5 --frame-id base --child-frame-id cam"; what is absent is zero.
Expected<FrameTransform> FromOptions(const std::vector<std::string>& words, const Place& place) {
  std::map<std::string, std::string> values;
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (words[i].starts_with("--")) values[words[i].substr(2)] = words[i + 1];
  }
  std::map<std::string, double> n = {{"qw", 1.0}};
  for (const char* key : {"x", "y", "z", "qx", "qy", "qz", "qw", "roll", "pitch", "yaw"}) {
    if (!values.contains(key)) continue;
    SEXTANT_ASSIGN_OR_RETURN(n[key], ParseFinite(values[key], place));
  }
  const bool has_angles =
      values.contains("roll") || values.contains("pitch") || values.contains("yaw");
  const std::array<double, 4> wxyz = has_angles ? QuaternionOf(n["yaw"], n["pitch"], n["roll"])
                                                : std::array{n["qw"], n["qx"], n["qy"], n["qz"]};
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, PoseOfNumbers({n["x"], n["y"], n["z"]}, wxyz,
                                                             std::string(place.file), place.line));
  return FrameTransform{values["frame-id"], values["child-frame-id"], pose, place.line};
}

// x y z and a quaternion or yaw pitch roll, then parent and child.
Expected<FrameTransform> FromOrder(const std::vector<std::string>& words, const Place& place) {
  std::vector<double> n;
  for (const std::string& word : words) {
    const Expected<double> number = ParseFinite(word, place);
    if (!number || n.size() == 7) break;
    n.push_back(*number);
  }
  if ((n.size() != 6 && n.size() != 7) || words.size() < n.size() + 2) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: expected the arguments x y z qx qy qz qw (or yaw pitch roll) "
                                 "parent child of a static transform",
                                 ToString(place)));
  }
  const std::array<double, 4> wxyz =
      n.size() == 6 ? QuaternionOf(n[3], n[4], n[5]) : std::array{n[6], n[3], n[4], n[5]};
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, PoseOfNumbers({n[0], n[1], n[2]}, wxyz,
                                                             std::string(place.file), place.line));
  return FrameTransform{words[n.size()], words[n.size() + 1], pose, place.line};
}

std::string AttributeOf(const tinyxml2::XMLElement* element, const char* name) {
  const char* value = element != nullptr ? element->Attribute(name) : nullptr;
  return value != nullptr ? value : "";
}

Expected<FrameTransform> JointOf(const tinyxml2::XMLElement& joint, const std::string& file) {
  const Place place{.file = file, .line = joint.GetLineNum(), .field = 0, .name = "origin"};
  const tinyxml2::XMLElement* origin = joint.FirstChildElement("origin");
  std::array<double, 6> n{};  // x y z, roll pitch yaw
  std::size_t at = 0;
  for (const char* name : {"xyz", "rpy"}) {
    const std::vector<std::string> words = Words(AttributeOf(origin, name));
    if (!words.empty() && words.size() != 3) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("{}: expected three numbers as {}", ToString(place), name));
    }
    for (std::size_t i = 0; i < words.size(); ++i) {
      SEXTANT_ASSIGN_OR_RETURN(n[at + i], ParseFinite(words[i], place));
    }
    at += 3;
  }
  SEXTANT_ASSIGN_OR_RETURN(
      const Rigid3d pose,
      PoseOfNumbers({n[0], n[1], n[2]}, QuaternionOf(n[5], n[4], n[3]), file, joint.GetLineNum()));
  return FrameTransform{AttributeOf(joint.FirstChildElement("parent"), "link"),
                        AttributeOf(joint.FirstChildElement("child"), "link"), pose,
                        joint.GetLineNum()};
}

// Fixed joints and static transforms, at any depth.
Expected<void> AddElements(const tinyxml2::XMLElement* element, const std::string& file,
                           std::vector<FrameTransform>& transforms) {
  for (; element != nullptr; element = element->NextSiblingElement()) {
    const std::string name = element->Name();
    const std::string type = AttributeOf(element, name == "node" ? "type" : "exec");
    const bool publishes = type == "static_transform_publisher" ||
                           AttributeOf(element, "exec") == "static_transform_publisher";
    if (name == "node" && publishes) {
      SEXTANT_ASSIGN_OR_RETURN(FrameTransform t, PublishedTransform(AttributeOf(element, "args"),
                                                                    file, element->GetLineNum()));
      transforms.push_back(std::move(t));
    } else if (name == "joint" && AttributeOf(element, "type") == "fixed") {
      SEXTANT_ASSIGN_OR_RETURN(FrameTransform t, JointOf(*element, file));
      transforms.push_back(std::move(t));
    } else {
      SEXTANT_RETURN_IF_ERROR(AddElements(element->FirstChildElement(), file, transforms));
    }
  }
  return {};
}

}  // namespace

Expected<FrameTransform> PublishedTransform(std::string_view arguments, const std::string& file,
                                            int line) {
  const Place place{.file = file, .line = line, .field = 0, .name = "static transform"};
  const std::vector<std::string> words = Words(arguments);
  const bool has_options = arguments.find("--") != std::string_view::npos;
  SEXTANT_ASSIGN_OR_RETURN(FrameTransform t,
                           has_options ? FromOptions(words, place) : FromOrder(words, place));
  if (!t.parent.empty() && !t.child.empty()) return t;
  return MakeError(ErrorCode::kParse,
                   ToString(place) + ": expected --frame-id and --child-frame-id");
}

Expected<StatedPose> ParsePoseXml(std::string_view text, const std::string& file) {
  if (text.size() > kMaxPoseXmlBytes) {
    return MakeError(ErrorCode::kParse, fmt::format("{}: expected a file of at most 1 MiB, got {} "
                                                    "bytes",
                                                    file, text.size()));
  }
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    return MakeError(ErrorCode::kParse, fmt::format("{}:{}: expected XML: {}", file,
                                                    document.ErrorLineNum(), document.ErrorName()));
  }
  std::vector<FrameTransform> transforms;
  SEXTANT_RETURN_IF_ERROR(AddElements(document.FirstChildElement(), file, transforms));
  if (!transforms.empty()) return ConnectFrames(transforms, OpticalFrameIn(text), file);
  return MakeError(ErrorCode::kMissingData,
                   file + ": expected a static_transform_publisher or a fixed joint");
}

Expected<StatedPose> ParsePoseLaunch(std::string_view text, const std::string& file) {
  std::vector<FrameTransform> transforms;
  std::size_t at = 0;
  int line = 1;
  std::size_t counted = 0;  // The lines up to here are counted.
  while ((at = text.find("arguments", at)) != std::string_view::npos) {
    const std::size_t open = text.find('[', at);
    const std::size_t close = text.find(']', at);
    if (close == std::string_view::npos || open > close) break;
    const std::string_view list = text.substr(open + 1, close - open - 1);
    at = close;
    if (list.find("frame-id") == std::string_view::npos && Words(list).size() < 8) continue;
    line += static_cast<int>(std::count(text.begin() + counted, text.begin() + open, '\n'));
    counted = open;
    SEXTANT_ASSIGN_OR_RETURN(FrameTransform t, PublishedTransform(list, file, line));
    transforms.push_back(std::move(t));
  }
  if (!transforms.empty()) return ConnectFrames(transforms, OpticalFrameIn(text), file);
  return MakeError(ErrorCode::kMissingData,
                   file + ": expected a Node with arguments=[...] of a static transform");
}

}  // namespace sextant
