// SPDX-License-Identifier: Apache-2.0
#include "base/spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "base/spec_text.h"

namespace sextant {
namespace {

// Deeper nesting has no use and would let a hostile text exhaust the stack.
constexpr int kMaxDepth = 32;

// A longer name or value has no use and would make every message about it as long.
constexpr std::size_t kMaxWord = 100;
constexpr std::size_t kMaxText = 1000;

bool IsWordCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '-' ||
         c == '+' || c == '/';
}

// The text for a message: of a long one, the part around the position.
std::string Excerpt(std::string_view text, std::size_t position) {
  constexpr std::size_t kReach = 60;
  const std::size_t begin = position > kReach ? position - kReach : 0;
  const std::string_view part = text.substr(begin, 2 * kReach);
  return fmt::format("'{}{}{}'", begin > 0 ? "..." : "", part,
                     begin + part.size() < text.size() ? "..." : "");
}

class SpecParser {
 public:
  explicit SpecParser(std::string_view text) : text_(text) {}

  Expected<std::vector<SpecNode>> ParseAll() {
    std::vector<SpecNode> specs;
    do {
      SEXTANT_ASSIGN_OR_RETURN(SpecNode spec, ParseNode(0));
      specs.push_back(std::move(spec));
    } while (Accept(','));
    SkipBlanks();
    if (position_ != text_.size()) return Fail("',' or the end");
    return specs;
  }

 private:
  Expected<SpecNode> ParseNode(int depth) {
    if (depth > kMaxDepth) return Fail(fmt::format("at most {} nested solvers", kMaxDepth));
    SpecNode node;
    SEXTANT_ASSIGN_OR_RETURN(node.name, Word());
    if (node.name.empty()) return Fail("the name of a solver");
    if (!Accept('(')) return node;
    if (Accept(')')) return node;
    do {
      SEXTANT_RETURN_IF_ERROR(ParseArgument(depth, node));
    } while (Accept(','));
    if (!Accept(')')) return Fail("',' or ')'");
    return node;
  }

  Expected<void> ParseArgument(int depth, SpecNode& node) {
    if (Accept('"')) {
      SEXTANT_ASSIGN_OR_RETURN(std::string text, RestOfText());
      node.options.emplace_back(kSpecText, std::move(text));
      return {};
    }
    const std::size_t start = position_;
    SEXTANT_ASSIGN_OR_RETURN(const std::string key, Word());
    if (!key.empty() && Accept('=')) {
      SEXTANT_ASSIGN_OR_RETURN(std::string value, Accept('"') ? RestOfText() : Word());
      if (value.empty()) return Fail(fmt::format("a value for '{}'", key));
      node.options.emplace_back(key, std::move(value));
      return {};
    }
    position_ = start;
    SEXTANT_ASSIGN_OR_RETURN(SpecNode inner, ParseNode(depth + 1));
    node.inner.push_back(std::move(inner));
    return {};
  }

  void SkipBlanks() {
    while (position_ < text_.size() &&
           std::isspace(static_cast<unsigned char>(text_[position_])) != 0) {
      ++position_;
    }
  }

  bool Accept(char expected) {
    SkipBlanks();
    if (position_ >= text_.size() || text_[position_] != expected) return false;
    ++position_;
    return true;
  }

  // Words include signs, for values such as -1e-3, and slashes, for paths.
  Expected<std::string> Word() {
    SkipBlanks();
    const std::size_t start = position_;
    while (position_ < text_.size()) {
      if (!IsWordCharacter(text_[position_])) break;
      if (position_ - start == kMaxWord) {
        return Fail(fmt::format("a name or value of at most {} characters", kMaxWord));
      }
      ++position_;
    }
    return std::string(text_.substr(start, position_ - start));
  }

  // After the opening quote.
  Expected<std::string> RestOfText() {
    const std::size_t end = text_.find('"', position_);
    if (end == std::string_view::npos) return Fail("a closing double quote");
    const std::string_view text = text_.substr(position_, end - position_);
    if (text.size() > kMaxText || text.find_first_not_of(' ') == std::string_view::npos ||
        std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20; })) {
      return Fail(fmt::format("a text of 1 to {} printable characters", kMaxText));
    }
    position_ = end + 1;
    return std::string(text);
  }

  tl::unexpected<Error> Fail(const std::string& expected) const {
    return MakeError(ErrorCode::kParse,
                     fmt::format("solver {}, column {}: expected {}", Excerpt(text_, position_),
                                 position_ + 1, expected));
  }

  std::string_view text_;
  std::size_t position_ = 0;
};

}  // namespace

Expected<std::vector<SpecNode>> ParseSpecList(std::string_view text) {
  return SpecParser(text).ParseAll();
}

Expected<SpecNode> ParseSpec(std::string_view text) {
  SEXTANT_ASSIGN_OR_RETURN(std::vector<SpecNode> specs, ParseSpecList(text));
  if (specs.size() != 1) {
    return MakeError(ErrorCode::kParse, fmt::format("expected one solver, got {} in {}",
                                                    specs.size(), Excerpt(text, 0)));
  }
  return std::move(specs.front());
}

std::string FormatSpec(const SpecNode& node) {
  std::vector<std::string> arguments;
  for (const SpecNode& inner : node.inner) arguments.push_back(FormatSpec(inner));
  for (const auto& [key, value] : node.options) {
    const bool is_word = std::all_of(value.begin(), value.end(), IsWordCharacter);
    const std::string quoted = is_word && key != kSpecText ? value : '"' + value + '"';
    arguments.push_back(key == kSpecText ? quoted : key + "=" + quoted);
  }
  if (arguments.empty()) return node.name;
  return fmt::format("{}({})", node.name, fmt::join(arguments, ","));
}

}  // namespace sextant
