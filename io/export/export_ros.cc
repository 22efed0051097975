// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "geometry/so3.h"
#include "io/export/export_texts.h"

namespace sextant {
namespace {

// The name of a node or joint: letters, digits and _ only.
std::string NameOf(const NamedTransform& transform) {
  std::string name = transform.parent + "_from_" + transform.child;
  std::replace_if(
      name.begin(), name.end(),
      [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
}

// The lines of the comment, without comment characters.
std::string Direction(const NamedTransform& t, const std::string& indent) {
  return fmt::format(
             "{0}{1}: the pose of {2} in {3}.\n"
             "{0}point_in_{3} = {1} * point_in_{2}\n",
             indent, NameOf(t), t.child, t.parent) +
         (t.camera_frame.empty()
              ? std::string()
              : fmt::format("{}{} is the camera's optical frame: x right, y down, z forward.\n",
                            indent, t.camera_frame));
}

std::string Xyz(const Rigid3d& pose) {
  const Eigen::Vector3d& t = pose.translation;
  return fmt::format("{} {} {}", t.x(), t.y(), t.z());
}

// "--x 1 --y 2 ... --qw 1"; `between` separates all options and values.
std::string Ros2Arguments(const NamedTransform& t, const char* quote, const char* between) {
  const Rigid3d& pose = t.parent_from_child;
  const std::pair<const char*, double> numbers[] = {
      {"--x", pose.translation.x()}, {"--y", pose.translation.y()}, {"--z", pose.translation.z()},
      {"--qx", pose.rotation.x()},   {"--qy", pose.rotation.y()},   {"--qz", pose.rotation.z()},
      {"--qw", pose.rotation.w()}};
  std::string text;
  for (const auto& [name, value] : numbers) {
    text += fmt::format("{1}{0}{1}{2}{1}{3}{1}{2}", name, quote, between, value);
  }
  return text + fmt::format("{0}--frame-id{0}{1}{0}{2}{0}{1}{0}--child-frame-id{0}{1}{0}{3}{0}",
                            quote, between, t.parent, t.child);
}

}  // namespace

std::string Ros1LaunchText(std::span<const NamedTransform> tree) {
  std::string text = "<launch>\n";
  for (const NamedTransform& t : tree) {
    const Eigen::Quaterniond& q = t.parent_from_child.rotation;
    text += fmt::format(
        "  <!--\n{}    args: x y z qx qy qz qw parent child\n  -->\n"
        "  <node pkg=\"tf2_ros\" type=\"static_transform_publisher\" name=\"{}\"\n"
        "        args=\"{} {} {} {} {} {} {}\" />\n",
        Direction(t, "    "), NameOf(t), Xyz(t.parent_from_child), q.x(), q.y(), q.z(), q.w(),
        t.parent, t.child);
  }
  return text + "</launch>\n";
}

std::string Ros2LaunchText(std::span<const NamedTransform> tree) {
  std::string text;
  for (const NamedTransform& t : tree) text += Direction(t, "# ");
  text +=
      "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\n"
      "def generate_launch_description():\n    return LaunchDescription([\n";
  for (const NamedTransform& t : tree) {
    text += fmt::format(
        "        Node(\n"
        "            package='tf2_ros',\n            executable='static_transform_publisher',\n"
        "            name='{}',\n            arguments=[{}],\n        ),\n",
        NameOf(t), Ros2Arguments(t, "'", ", "));
  }
  return text + "    ])\n";
}

std::string Ros2YamlText(std::span<const NamedTransform> tree) {
  std::string text;
  for (const NamedTransform& t : tree) text += Direction(t, "# ");
  text += "launch:\n";
  for (const NamedTransform& t : tree) {
    text += fmt::format(
        "  - node:\n      pkg: tf2_ros\n      exec: static_transform_publisher\n"
        "      name: {}\n      args: \"{}\"\n",
        NameOf(t), Ros2Arguments(t, "", " "));
  }
  return text;
}

std::string TfYamlText(const NamedTransform& t) {
  const Eigen::Vector3d& p = t.parent_from_child.translation;
  const Eigen::Quaterniond& q = t.parent_from_child.rotation;
  return fmt::format(
      "# geometry_msgs/TransformStamped\n{}header:\n  frame_id: \"{}\"\nchild_frame_id: \"{}\"\n"
      "transform:\n  translation: {{x: {}, y: {}, z: {}}}\n"
      "  rotation: {{x: {}, y: {}, z: {}, w: {}}}\n",
      Direction(t, "# "), t.parent, t.child, p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

std::string UrdfText(std::span<const NamedTransform> tree) {
  std::string text;
  for (const NamedTransform& t : tree) {
    const EulerZyx euler = ToEulerZyx(t.parent_from_child.rotation);
    text += fmt::format(
        "<!--\n{}  Insert this joint into the robot's description, which must have both links.\n"
        "  rpy: R = Rz(yaw) Ry(pitch) Rx(roll)\n-->\n"
        "<joint name=\"{}\" type=\"fixed\">\n  <parent link=\"{}\" />\n  <child link=\"{}\" />\n"
        "  <origin xyz=\"{}\" rpy=\"{} {} {}\" />\n</joint>\n",
        Direction(t, "  "), NameOf(t), t.parent, t.child, Xyz(t.parent_from_child), euler.roll,
        euler.pitch, euler.yaw);
  }
  return text;
}

}  // namespace sextant
