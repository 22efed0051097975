// SPDX-License-Identifier: Apache-2.0
#include "base/text/escape.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/text/code_point.h"
#include "base/text/printable.h"

namespace sextant {
namespace {

bool IsLetterOrDigit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

bool IsNumber(std::string_view text) {
  double value = 0.0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size();
}

std::string_view LatexPiece(const char& c) {
  switch (c) {
    case '\\':
      return "\\textbackslash{}";
    case '~':
      return "\\textasciitilde{}";
    case '^':
      return "\\textasciicircum{}";
    case '<':
      return "\\textless{}";
    case '>':
      return "\\textgreater{}";
    case '|':
      return "\\textbar{}";
    default:
      return {&c, 1};
  }
}

// Whether the character at `i` would begin or end markup of Markdown.
bool IsMarkup(std::string_view text, std::size_t i) {
  const char next = i + 1 < text.size() ? text[i + 1] : '\0';
  const char before = i > 0 ? text[i - 1] : ' ';
  switch (text[i]) {
    case '_':
      return !IsLetterOrDigit(before) || !IsLetterOrDigit(next);
    case ']':
      return next == '(' || next == '[' || next == ':';
    case '#':
    case '+':
    case '-':
    case '=':
      return i == 0 && (next == ' ' || next == text[0]);
    case '>':
      return i == 0;
    case '.':
    case ')':
      return i > 0 && next == ' ' && text.find_first_not_of("0123456789") == i;
    default:
      return std::string_view("\\`*~$|").find(text[i]) != std::string_view::npos;
  }
}

// The pieces of HTML that Markdown passes on: <tag>, </tag>, <!--, <?, and &entity;.
std::string_view HtmlPiece(std::string_view text, std::size_t i) {
  const char next = i + 1 < text.size() ? text[i + 1] : '\0';
  const bool opens = IsLetterOrDigit(next) || next == '/' || next == '!' || next == '?';
  if (text[i] == '<' && opens) return "&lt;";
  if (text[i] == '&' && (IsLetterOrDigit(next) || next == '#')) return "&amp;";
  return {};
}

// "`code`" at the beginning of the text, with the bars that would end a table's cell escaped; empty
// if there is none.
std::string CodeSpan(std::string_view text, std::size_t& bytes) {
  const std::size_t end = text.starts_with('`') ? text.find('`', 1) : std::string_view::npos;
  if (end == std::string_view::npos || end == 1) return {};
  bytes = end + 1;
  std::string code;
  for (const char c : text.substr(0, bytes)) {
    code += c == '|' ? std::string("\\|") : std::string(1, c);
  }
  return code;
}

}  // namespace

std::string GnuplotText(std::string text) {
  std::string quoted = "\"";
  for (const char c : PrintableLine(std::move(text))) {
    // gnuplot reads up to four digits as one number, so that none may follow as it is.
    const bool is_digit = c >= '0' && c <= '9';
    const bool is_literal = (IsLetterOrDigit(c) && !is_digit) || c == ' ' || (c & 0x80) != 0;
    quoted += is_literal ? std::string(1, c) : fmt::format("\\{:03o}", c);
  }
  return quoted + "\"";
}

std::string LatexText(std::string text) {
  text = PrintableLine(std::move(text));
  std::string escaped;
  for (const char& c : text) {
    const bool is_argument = escaped.empty() && (c == '[' || c == '*');
    if (is_argument) {
      escaped += std::string("{") + c + "}";
      continue;
    }
    if (std::string_view("_%&#${}").find(c) != std::string_view::npos) escaped += '\\';
    escaped += LatexPiece(c);
  }
  return escaped;
}

std::string MarkdownText(std::string text) {
  text = PrintableLine(std::move(text));
  const std::string_view all = text;
  std::string escaped;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::size_t bytes = 0;
    const std::string code = CodeSpan(all.substr(i), bytes);
    if (!code.empty()) {
      escaped += code;
      i += bytes - 1;
      continue;
    }
    const std::string_view html = HtmlPiece(text, i);
    if (!html.empty()) {
      escaped += html;
      continue;
    }
    if (IsMarkup(text, i)) escaped += '\\';
    escaped += text[i];
  }
  return escaped;
}

std::string CsvField(std::string text) {
  text = PrintableLine(std::move(text));
  const bool is_formula = text.find_first_of("=+-@") == 0 && !IsNumber(text) && text.size() > 1;
  if (is_formula) text.insert(0, "'");
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string YamlQuoted(std::string text) {
  std::string quoted = "\"";
  for (const char c : PrintableLine(std::move(text))) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

std::string HtmlText(std::string text) {
  std::string escaped;
  for (const char c : PrintableLine(std::move(text))) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

// The library writes only the controls below 0x20 as \uNNNN; the others can stand in strings alone.
std::string JsonText(const nlohmann::ordered_json& document, int indent) {
  std::string text =
      document.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x7f; };
  if (std::all_of(text.begin(), text.end(), is_ascii)) return text;
  std::string escaped;
  for (std::string_view rest = text; !rest.empty();) {
    const CodePoint point = FirstCodePoint(rest);
    if (point.value >= 0x7f && IsControl(point.value)) {
      escaped += fmt::format("\\u{:04x}", static_cast<unsigned>(point.value));
    } else {
      escaped += rest.substr(0, point.bytes);
    }
    rest.remove_prefix(point.bytes);
  }
  return escaped;
}

std::string JsonLine(const nlohmann::ordered_json& document) {
  std::string text = JsonText(document, /*indent=*/-1);
  text.pop_back();
  return text;
}

// Outside of strings JSON has none of these characters.
std::string ScriptJson(const nlohmann::ordered_json& document) {
  std::string escaped;
  for (const char c : JsonText(document, -1)) {
    const bool is_markup = c == '<' || c == '>' || c == '&';
    escaped += is_markup ? fmt::format("\\u{:04x}", static_cast<unsigned>(c)) : std::string(1, c);
  }
  return escaped;
}

}  // namespace sextant
