// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#ifdef SEXTANT_WITH_OPENCV
#include <opencv2/core.hpp>
#endif

#include "io/cameras/camera_tree.h"

namespace sextant {

#ifdef SEXTANT_WITH_OPENCV
namespace {

constexpr std::size_t kMaxXmlBytes = std::size_t{1} << 20;

YamlNode TreeOf(const cv::FileNode& node, std::size_t depth) {
  YamlNode tree;
  if (depth > kMaxYamlDepth) return tree;
  if (node.isMap() || node.isSeq()) {
    tree.kind = node.isMap() ? YamlNode::Kind::kMap : YamlNode::Kind::kSequence;
    for (const cv::FileNode& item : node) {
      if (node.isMap()) tree.keys.push_back(item.name());
      tree.items.push_back(TreeOf(item, depth + 1));
    }
  } else if (node.isInt() || node.isReal()) {
    tree.kind = YamlNode::Kind::kText;
    tree.text = fmt::format("{}", static_cast<double>(node));
  } else if (node.isString()) {
    tree.kind = YamlNode::Kind::kText;
    tree.text = static_cast<std::string>(node);
  }
  return tree;
}

}  // namespace

Expected<YamlNode> ParseCameraXml(std::string_view text, const std::string& file) {
  if (text.size() > kMaxXmlBytes) {
    return MakeError(ErrorCode::kParse, fmt::format("{}: expected a camera file of at most 1 MiB, "
                                                    "got {} bytes",
                                                    file, text.size()));
  }
  try {
    const cv::FileStorage storage(std::string(text), cv::FileStorage::READ |
                                                         cv::FileStorage::MEMORY |
                                                         cv::FileStorage::FORMAT_XML);
    return TreeOf(storage.root(), 0);
  } catch (const cv::Exception& error) {
    return MakeError(
        ErrorCode::kParse,
        fmt::format("{}: expected OpenCV's XML (<opencv_storage>): {}", file, error.err));
  }
}
#else
Expected<YamlNode> ParseCameraXml(std::string_view /*text*/, const std::string& file) {
  return MakeError(ErrorCode::kParse,
                   fmt::format("{}: expected YAML: XML is read only where sextant is built with "
                               "-DSEXTANT_OPENCV=ON",
                               file));
}
#endif

}  // namespace sextant
