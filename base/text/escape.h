// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace sextant {

// Text of others within an output format: the only function for each format. All of them take any
// bytes. Those of a single text begin with PrintableLine, so that it can neither end a line nor
// hold a control character; a reader of the format sees what PrintableLine gives. For terminals see
// base/text/printable.h.

/// A string of gnuplot in double quotes, with all but letters and blanks as octal numbers: gnuplot
/// 5.4 ends a string in single quotes at two doubled quotes in a row. Enhanced text is a
/// matter of the command: it must say noenhanced.
std::string GnuplotText(std::string text);

/// Text of LaTeX, at the beginning of a table's cell too, where [ and * would be read as arguments
/// of the row's end before it.
std::string LatexText(std::string text);

/// Text of GitHub's Markdown within a paragraph, heading or table cell. Code in `backquotes` stays
/// code; HTML, links, emphasis and the bars of tables become text.
std::string MarkdownText(std::string text);

/// A field of CSV (RFC 4180), quoted if it must be. A text that a spreadsheet would take for a
/// formula begins with ' instead; numbers stay numbers.
std::string CsvField(std::string text);

/// A scalar of YAML in double quotes.
std::string YamlQuoted(std::string text);

/// Text of HTML, between tags or as an attribute in double quotes.
std::string HtmlText(std::string text);

/// The document as text, ending with a line feed. Control characters in strings are written as
/// \uNNNN, and so survive; bytes that are not UTF-8 become U+FFFD.
std::string JsonText(const nlohmann::ordered_json& document, int indent = 2);

/// The same on one line, without a line feed at its end.
std::string JsonLine(const nlohmann::ordered_json& document);

/// The same on one line, for a script element of HTML: no text in it can end the element or open a
/// comment.
std::string ScriptJson(const nlohmann::ordered_json& document);

}  // namespace sextant
