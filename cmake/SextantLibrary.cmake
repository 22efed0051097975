# SPDX-License-Identifier: Apache-2.0
# Defines a library of one folder: sextant_library(<folder> PUBLIC ... PRIVATE ...).
#
# Sources are globbed, so that a new solver is one new file; CONFIGURE_DEPENDS repeats this at each
# build. The link line is the layering: it names exactly the folders and libraries that the sources
# include, PUBLIC if a header does. tests/layering checks it.
function(sextant_library name)
  cmake_parse_arguments(ARG "" "" "PUBLIC;PRIVATE" ${ARGN})
  string(REPLACE "/" "_" target ${name})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
  add_library(sextant_${target} STATIC ${sources})
  add_library(sextant::${target} ALIAS sextant_${target})
  target_sources(sextant_${target} PUBLIC
    FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${headers})
  target_compile_features(sextant_${target} PUBLIC cxx_std_20)
  target_link_libraries(sextant_${target}
    PUBLIC ${ARG_PUBLIC}
    PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:sextant_options>)
  set_target_properties(sextant_${target} PROPERTIES EXPORT_NAME ${target})
  install(TARGETS sextant_${target} EXPORT sextantTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sextant)
endfunction()

# Several libraries under one name: sextant_umbrella(<folder> <parts of it>...). For programs; a library
# links the parts that it uses.
function(sextant_umbrella name)
  string(REPLACE "/" "_" target ${name})
  list(TRANSFORM ARGN PREPEND sextant::${target}_ OUTPUT_VARIABLE parts)
  add_library(sextant_${target} INTERFACE)
  add_library(sextant::${target} ALIAS sextant_${target})
  target_link_libraries(sextant_${target} INTERFACE ${parts})
  set_target_properties(sextant_${target} PROPERTIES EXPORT_NAME ${target})
  install(TARGETS sextant_${target} EXPORT sextantTargets)
endfunction()
