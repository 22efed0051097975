# SPDX-License-Identifier: Apache-2.0
# cmake -D SOURCE=... -D PREFIX=... -P check_prefix.cmake: scenes, experiments, examples and pages
# are installed, and every page that README.md links to is among them.
set(doc ${PREFIX}/share/doc/sextant)
set(missing "")

function(expect_installed source_glob below)
  file(GLOB_RECURSE files RELATIVE ${SOURCE} ${SOURCE}/${source_glob})
  list(LENGTH files count)
  if(count EQUAL 0)
    message(FATAL_ERROR "nothing in the source tree is named ${source_glob}")
  endif()
  foreach(file IN LISTS files)
    if(NOT EXISTS ${below}/${file})
      list(APPEND missing ${below}/${file})
    endif()
  endforeach()
  set(missing "${missing}" PARENT_SCOPE)
endfunction()

expect_installed(experiments/*.yaml ${PREFIX}/share/sextant)
expect_installed(docs/* ${doc})
expect_installed(examples/*.cc ${doc})
expect_installed(examples/*.py ${doc})

file(READ ${doc}/README.md readme)
# A lone bracket in an item would join it with the next one of the list.
string(REPLACE "](" "link:" readme "${readme}")
string(REGEX MATCHALL "link:docs/[^)#]+" links "${readme}")
foreach(link IN LISTS links)
  string(REPLACE "link:" "" page "${link}")
  if(NOT EXISTS ${doc}/${page})
    list(APPEND missing ${doc}/${page})
  endif()
endforeach()
list(LENGTH links count)
if(count EQUAL 0)
  message(FATAL_ERROR "README.md links to no page")
endif()

if(missing)
  list(JOIN missing "\n  " text)
  message(FATAL_ERROR "not installed:\n  ${text}")
endif()
