// SPDX-License-Identifier: Apache-2.0
#include "io/text/yaml_node.h"

#include <fmt/core.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <istream>

#include "base/text/code_point.h"
#include "io/text/metered_text.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

// The memory that the tree and the scanner's tokens may take together. Copies of the text and the
// program itself have the rest of what ParseYaml promises.
constexpr std::size_t kBytesPerByte = 17;
constexpr std::size_t kBytesForAny = std::size_t{40} << 20;

constexpr const char* kNoAliases =
    "aliases (*name) are not supported, nor anchors (&name); write the value out";

// Builds the tree from the parser's events; reports errors by the exception of the parser itself.
class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(MeteredText& text, std::size_t budget) : text_(text), budget_(budget) {}

  YamlNode TakeRoot() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    RefuseAnchor(mark, anchor);
    Add(mark, YamlNode::Kind::kNull, {});
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { Refuse(mark, kNoAliases); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                const std::string& value) override {
    RefuseAnchor(mark, anchor);
    Add(mark, YamlNode::Kind::kText, value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value style) override {
    RefuseAnchor(mark, anchor);
    Open(mark, YamlNode::Kind::kSequence, style);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value style) override {
    RefuseAnchor(mark, anchor);
    Open(mark, YamlNode::Kind::kMap, style);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  struct OpenNode {
    YamlNode* node = nullptr;
    bool in_brackets = false;
  };

  // Counts bytes that are allocated; `transient` ones are freed again.
  void Charge(const YAML::Mark& mark, std::size_t bytes, std::size_t transient = 0) {
    used_ += bytes;
    if (used_ + transient > budget_) Refuse(mark, "too many values for a text of this size");
    text_.OnEvent(budget_ - used_);
  }

  template <class Item>
  Item& Append(const YAML::Mark& mark, std::vector<Item>& items) {
    if (items.size() == items.capacity()) {
      const std::size_t before = items.capacity();
      const std::size_t after = std::max<std::size_t>(1, 2 * before);
      Charge(mark, (after - before) * sizeof(Item), before * sizeof(Item));
      items.reserve(after);
    }
    return items.emplace_back();
  }

  [[noreturn]] static void Refuse(const YAML::Mark& mark, const std::string& why) {
    throw YAML::ParserException(mark, why);
  }

  // The parser remembers every anchor until its end, and without aliases none has a use.
  static void RefuseAnchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != YAML::NullAnchor) Refuse(mark, kNoAliases);
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
    Append(mark, map.keys) = key;
  }

  // Texts of several lines may be meant; YamlFields refuses them where one line is expected.
  void RefuseControls(const YAML::Mark& mark, const std::string& text) const {
    std::string line = text;
    std::erase(line, '\n');
    if (IsPlainLine(line)) return;
    const bool has_key = !open_.empty() && !open_.back().node->keys.empty();
    Refuse(mark, fmt::format("{}control characters are not allowed in a text, got {}",
                             has_key ? Printable(open_.back().node->keys.back(), 60) + ": " : "",
                             Quoted(text)));
  }

  YamlNode* Add(const YAML::Mark& mark, YamlNode::Kind kind, const std::string& text) {
    RefuseControls(mark, text);
    constexpr std::size_t kIndentation = 64;  // The scanner never frees what it notes of one.
    constexpr std::size_t kInPlace = 15;      // Shorter texts take no memory of their own.
    const std::size_t size = text.size() > kInPlace ? text.size() : 0;
    const bool in_brackets = !open_.empty() && open_.back().in_brackets;
    // The text is in the token and in the event too.
    Charge(mark, (in_brackets ? 0 : kIndentation) + size, 2 * size);
    YamlNode* node = &root_;
    if (!open_.empty()) {
      // Only the last item of a node is ever open, so its address stays valid until it is closed.
      YamlNode& parent = *open_.back().node;
      if (ExpectsKey(parent)) {
        if (kind != YamlNode::Kind::kText) Refuse(mark, "expected a plain key");
        AddKey(mark, parent, text);
        return nullptr;
      }
      node = &Append(mark, parent.items);
    }
    node->kind = kind;
    node->line = mark.line + 1;
    node->text = text;
    return node;
  }

  void Open(const YAML::Mark& mark, YamlNode::Kind kind, YAML::EmitterStyle::value style) {
    if (open_.size() == kMaxYamlDepth) {
      Refuse(mark, fmt::format("nested deeper than {} levels", kMaxYamlDepth));
    }
    YamlNode* const node = Add(mark, kind, {});
    open_.push_back({node, style == YAML::EmitterStyle::Flow});
  }

  MeteredText& text_;
  std::size_t budget_;
  std::size_t used_ = 0;
  YamlNode root_;
  std::vector<OpenNode> open_;
};

}  // namespace

const YamlNode* YamlNode::Find(std::string_view key) const {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &items[static_cast<std::size_t>(found - keys.begin())];
}

Expected<YamlNode> ParseYaml(std::string_view text, const std::string& file) {
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
    const std::size_t budget = kBytesForAny + kBytesPerByte * text.size();
    MeteredText metered(text, budget);
    std::istream stream(&metered);
    YAML::Parser parser(stream);
    TreeBuilder tree(metered, budget);
    if (!parser.HandleNextDocument(tree)) {
      return MakeError(ErrorCode::kParse, fmt::format("{}:1: the file is empty, expected YAML",
                                                      ToString(Place{.file = file})));
    }
    TreeBuilder second(metered, budget);
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
