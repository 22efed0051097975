// SPDX-License-Identifier: Apache-2.0
#include "fuzz/hostile.h"

#include <algorithm>

namespace sextant::test {
namespace {

std::string Repeated(std::string_view piece, std::size_t times) {
  std::string text;
  text.reserve(piece.size() * times);
  for (std::size_t i = 0; i < times; ++i) text += piece;
  return text;
}

// Block YAML: a map in a map in a map.
std::string NestedMaps(int depth) {
  std::string text;
  for (int i = 0; i < depth; ++i) text += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  return text;
}

const std::vector<std::string>& HostilePieces() {
  static const std::vector<std::string> pieces = {
      "",
      "\n",
      "\r",
      "\t",
      std::string(1, '\0'),
      "\x1b[2J",
      "\x7f",
      "\xff\xfe",
      "\xc3",
      "\xe2\x80\xae",
      ":",
      ",",
      "-",
      "[",
      "{",
      "(",
      "\"",
      "'",
      "%",
      "#",
      "|",
      "? ",
      "<<",
      "!!",
      "&a ",
      "*a",
      "****************",
      "../../",
      "$(touch x)",
      "nan",
      "-nan",
      ".nan",
      "inf",
      "1e999",
      "1e-999",
      "-1",
      "4294967295",
      "18446744073709551615",
      "99999999999999999999",
      "0x10",
      std::string(4, '\xff'),
      std::string(8, '\x7f'),
  };
  return pieces;
}

void ReplacePart(std::string& bytes, Random& random) {
  const std::uint64_t at = random.Below(bytes.size());
  const std::uint64_t length = random.Below(2) == 0 ? random.Below(4) : random.Below(40);
  const std::string part = bytes.substr(at, length);
  const std::uint64_t piece = random.Below(HostilePieces().size());
  const bool is_doubled = random.Below(4) == 0;
  bytes.replace(at, length, is_doubled ? part + part : HostilePieces()[piece]);
}

void FlipBit(std::string& bytes, Random& random) {
  const std::uint64_t at = random.Below(bytes.size());
  const std::uint64_t bit = random.Below(8);
  bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ (1U << bit));
}

}  // namespace

const std::vector<HostileInput>& HostileInputs() {
  static const std::vector<HostileInput> inputs = {
      {"nothing", ""},
      {"a zero byte", std::string(1, '\0')},
      {"zeros", std::string(1U << 16U, '\0')},
      {"ones", std::string(1U << 16U, '\xff')},
      {"brackets", Repeated("[", 100'000)},
      {"brackets after a key", "boards: " + Repeated("[", 100'000)},
      {"braces", Repeated("{", 100'000)},
      {"JSON in JSON", Repeated("{\"a\":", 100'000)},
      {"parentheses", Repeated("a(", 100'000)},
      {"dashes", Repeated("- ", 100'000)},
      {"questions", Repeated("? ", 100'000)},
      {"nested maps", NestedMaps(500)},
      {"aliases", "a: &a [1]\nb: &b [*a, *a]\nc: &c [*b, *b]\nd: [*c, *c]\n"},
      {"stars", Repeated("*a", 100'000)},
      {"quotes", Repeated("\"", 99'999)},
      {"digits", Repeated("1", 1'000'000)},
      {"commas", Repeated("1,", 500'000)},
      {"lines", Repeated("1 2 3\n", 100'000)},
      {"blank lines", Repeated("\n", 100'000)},
      {"carriage returns", Repeated("\r", 100'000)},
      {"a promise of many", "1000000000\n1 2 3\n"},
      {"a promise of more", "18446744073709551615\n1 2 3\n"},
      {"control characters", "\x1b]0;title\x07: \x1b[2J\r\x08\x7f\n"},
      {"no UTF-8", "\xff\xfe\xc3\x28: \xe2\x82 \xf0\x28\x8c\x28\n"},
      {"a byte order mark",
       "\xef\xbb\xbf"
       "1\n1 2 3\n4 5 6\n"},
      {"no numbers", "nan,inf,-nan,1e999\n.nan .inf -.inf\n"},
  };
  return inputs;
}

std::string Damaged(std::string bytes, Random& random) {
  const std::uint64_t faults = 1 + random.Below(3);
  for (std::uint64_t i = 0; i < faults && !bytes.empty(); ++i) {
    const bool is_flipped = random.Below(3) == 0;
    is_flipped ? FlipBit(bytes, random) : ReplacePart(bytes, random);
  }
  return bytes;
}

}  // namespace sextant::test
