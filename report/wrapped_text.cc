// SPDX-License-Identifier: Apache-2.0
#include "report/wrapped_text.h"

#include <algorithm>
#include <sstream>

namespace sextant {

std::string Wrapped(const std::string& text, std::size_t width) {
  std::string wrapped;
  std::size_t column = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = std::min(text.find(' ', i), text.size());
    const std::size_t length = end - i;
    if (column > 0 && column + 1 + length > width) {
      wrapped += '\n';
      column = 0;
    } else if (column > 0) {
      wrapped += ' ';
      ++column;
    }
    wrapped += text.substr(i, length);
    column += length;
    i = end + 1;
  }
  return wrapped + "\n";
}

std::string Narrow(const std::string& text) {
  std::string narrow;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.size() <= kTextWidth) {
      narrow += line + "\n";
      continue;
    }
    const std::size_t indent = line.find_first_not_of(' ');
    const std::string first(indent, ' ');
    const std::string hanging(indent == 0 ? 0 : indent + 2, ' ');
    std::istringstream parts(Wrapped(line.substr(indent), kTextWidth - hanging.size()));
    bool is_first = true;
    for (std::string part; std::getline(parts, part); is_first = false) {
      narrow += (is_first ? first : hanging) + part + "\n";
    }
  }
  return narrow;
}

}  // namespace sextant
