// SPDX-License-Identifier: Apache-2.0
#include "io/text/yaml_node.h"

#include <fmt/core.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <sstream>

#include "base/text/code_point.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

// Builds the tree from the parser's events; reports errors by the exception of the parser itself.
class TreeBuilder final : public YAML::EventHandler {
 public:
  YamlNode TakeRoot() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    Add(mark, YamlNode::Kind::kNull, {});
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    Refuse(mark, "aliases (*name) are not supported; write the value out");
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string& value) override {
    Add(mark, YamlNode::Kind::kText, value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    Open(mark, YamlNode::Kind::kSequence);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    Open(mark, YamlNode::Kind::kMap);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  [[noreturn]] static void Refuse(const YAML::Mark& mark, const std::string& why) {
    throw YAML::ParserException(mark, why);
  }

  static bool ExpectsKey(const YamlNode& node) {
    return node.kind == YamlNode::Kind::kMap && node.keys.size() == node.items.size();
  }

  void AddKey(const YAML::Mark& mark, YamlNode& map, const std::string& key) {
    if (!IsPlainLine(key)) Refuse(mark, "expected a key of one line, got " + Quoted(key));
    if (std::find(map.keys.begin(), map.keys.end(), key) != map.keys.end()) {
      Refuse(mark, "the key " + Quoted(key) + " appears twice");
    }
    constexpr std::size_t kMaxKeys = 256;
    if (map.keys.size() == kMaxKeys) Refuse(mark, "more than 256 keys in one map");
    map.keys.push_back(key);
  }

  // Texts of several lines may be meant; YamlFields refuses them where one line is expected.
  void RefuseControls(const YAML::Mark& mark, const std::string& text) const {
    std::string line = text;
    std::erase(line, '\n');
    if (IsPlainLine(line)) return;
    const bool has_key = !open_.empty() && !open_.back()->keys.empty();
    Refuse(mark, fmt::format("{}control characters are not allowed in a text, got {}",
                             has_key ? Printable(open_.back()->keys.back(), 60) + ": " : "",
                             Quoted(text)));
  }

  YamlNode* Add(const YAML::Mark& mark, YamlNode::Kind kind, const std::string& text) {
    RefuseControls(mark, text);
    YamlNode* node = &root_;
    if (!open_.empty()) {
      // Only the last item of a node is ever open, so its address stays valid until it is closed.
      YamlNode& parent = *open_.back();
      if (ExpectsKey(parent)) {
        if (kind != YamlNode::Kind::kText) Refuse(mark, "expected a plain key");
        AddKey(mark, parent, text);
        return nullptr;
      }
      node = &parent.items.emplace_back();
    }
    node->kind = kind;
    node->line = mark.line + 1;
    node->text = text;
    return node;
  }

  void Open(const YAML::Mark& mark, YamlNode::Kind kind) {
    if (open_.size() == kMaxYamlDepth) {
      Refuse(mark, fmt::format("nested deeper than {} levels", kMaxYamlDepth));
    }
    open_.push_back(Add(mark, kind, {}));
  }

  YamlNode root_;
  std::vector<YamlNode*> open_;
};

}  // namespace

const YamlNode* YamlNode::Find(std::string_view key) const {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &items[static_cast<std::size_t>(found - keys.begin())];
}

Expected<YamlNode> ParseYaml(const std::string& text, const std::string& file) {
  if (text.size() > kMaxYamlBytes) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: expected at most {} bytes of YAML, got {}",
                                 ToString(Place{.file = file}), kMaxYamlBytes, text.size()));
  }
  // yaml-cpp treats a zero byte as the end of the file.
  if (text.find('\0') != std::string::npos) {
    const auto line =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find('\0')), '\n');
    return MakeError(
        ErrorCode::kParse,
        fmt::format("{}: expected text, got a zero byte; is it a binary file?",
                    ToString(Place{.file = file, .line = static_cast<int>(line) + 1})));
  }
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    TreeBuilder tree;
    if (!parser.HandleNextDocument(tree)) {
      return MakeError(ErrorCode::kParse, fmt::format("{}:1: the file is empty, expected YAML",
                                                      ToString(Place{.file = file})));
    }
    TreeBuilder second;
    if (parser.HandleNextDocument(second)) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("{}:{}: expected one YAML document, got a second",
                                   ToString(Place{.file = file}), second.TakeRoot().line));
    }
    return tree.TakeRoot();
  } catch (const YAML::Exception& error) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: not valid YAML: {}",
                                 ToString(Place{.file = file, .line = error.mark.line + 1}),
                                 Printable(error.msg, 200)));
  }
}

}  // namespace sextant
