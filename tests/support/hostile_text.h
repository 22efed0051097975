// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace sextant::test {

/// Texts that a hostile file could hold as a name, title or label, for every output format.
inline const std::vector<std::string>& HostileTexts() {
  using namespace std::string_literals;
  static const std::vector<std::string> texts = {
      "",
      " ",
      "plain",
      "it's",
      "''",
      "\"quoted\" \"\"",
      "back\\slash \\\\ \\n \\",
      "S\n!touch owned\n#",
      "S\r\n!touch owned\r#",
      "x' \n system('touch owned') '",
      "x'; system \"touch owned\"; print '",
      "`touch owned`",
      "$(touch owned) ${HOME} $HOME",
      "; touch owned; | touch owned & touch owned && touch owned",
      "%s %n %g %% {} {0} {{}}",
      "_sub ^sup &amp ~tilde #hash $dollar %percent {brace} @at",
      "{/Bold x}_{a}^{b} &{c} ~d{e} @f",
      "<script>alert(1)</script><img src=x onerror=alert(1)>",
      "]]> --> <!-- <?xml <![CDATA[ &lt; &#60; &#x3c;",
      "-- --option -x",
      "../../x",
      "/tmp/x",
      ".hidden",
      "a/b\\c:d*e?f",
      "nul\0inside"s,
      "\0"s,
      "\x1b[31mred\x1b[0m \x1b]0;title\x07 \x1b[2J",
      "bell\a back\b tab\t vertical\v form\f del\x7f",
      "c1 \xc2\x9b\x33\x31m \xc2\x85 \xc2\x80",
      "invalid \x80 \xff \xc0\xaf \xe2\x82 \xed\xa0\x80 \xf4\x90\x80\x80 \xf8\x88\x80\x80\x80",
      "right \xe2\x80\xaeto left\xe2\x80\xac \xe2\x81\xa6isolate\xe2\x81\xa9",
      "lines \xe2\x80\xa8 and \xe2\x80\xa9 end",
      "\xef\xbf\xbe\xef\xbf\xbf",
      "gr\xc3\xbc\xc3\x9f \xe6\x97\xa5\xe6\x9c\xac \xf0\x9f\x98\x80",
      "=1+1",
      "+cmd|' /C calc'!A0",
      "-2+3+cmd|' /C calc'!A0",
      "@SUM(1+1)",
      "=HYPERLINK(\"http://x\",\"y\"), b",
      "[click](javascript:alert(1)) ![x](http://x) [a]: http://x",
      "| a | b |",
      "# heading",
      "1. item",
      "- item",
      "**bold** _it_ ~~s~~ `code` ``two` `",
      "[0, 1] and * at the row's begin",
      "* star",
      "\\input{/etc/passwd} \\write18{touch owned}",
      "key: value # comment",
      "&anchor *alias !tag !!python/object",
      "\\x1b \\u202e",
      std::string(100'000, 'A'),
      std::string(1000, '\''),
      std::string(1000, '`'),
  };
  return texts;
}

}  // namespace sextant::test
