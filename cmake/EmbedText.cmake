# SPDX-License-Identifier: Apache-2.0
# cmake -DFUNCTION=Name -DHEADER=folder/header.h -DOUT=file.cc "-DIN=a;b" -P EmbedText.cmake: writes a
# source that defines `std::string_view Name()`, the text of the files one after the other; an empty
# text for no file. A literal in pieces of 8000 bytes keeps within every compiler's limit of a line.
set(text "")
foreach(file IN LISTS IN)
  file(READ "${file}" content)
  string(APPEND text "${content}\n")
endforeach()
set(literals "")
string(LENGTH "${text}" length)
set(at 0)
while(at LESS length)
  string(SUBSTRING "${text}" ${at} 8000 piece)
  string(APPEND literals "R\"~text~(${piece})~text~\"\n")
  math(EXPR at "${at} + 8000")
endwhile()
if(NOT literals)
  set(literals "\"\"")
endif()
file(WRITE "${OUT}" "// Written by cmake/EmbedText.cmake.
#include \"${HEADER}\"

namespace sextant {

std::string_view ${FUNCTION}() {
  static constexpr char kText[] =
${literals};
  return {kText, sizeof kText - 1};
}

}  // namespace sextant
")
