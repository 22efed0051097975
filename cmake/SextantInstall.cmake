# SPDX-License-Identifier: Apache-2.0
# `cmake --install`: the program, the libraries for find_package(sextant), and the scenes,
# experiments, examples and pages that README.md names.
include(CMakePackageConfigHelpers)

set(SEXTANT_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/sextant)
configure_package_config_file(cmake/sextantConfig.cmake.in ${PROJECT_BINARY_DIR}/sextantConfig.cmake
  INSTALL_DESTINATION ${SEXTANT_CMAKE_DIR})
# Before 1.0 a minor version may break the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sextantConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sextantConfig.cmake ${PROJECT_BINARY_DIR}/sextantConfigVersion.cmake
  DESTINATION ${SEXTANT_CMAKE_DIR})
install(EXPORT sextantTargets NAMESPACE sextant:: DESTINATION ${SEXTANT_CMAKE_DIR})

install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} OPTIONAL
  COMPONENT program)
# As in the source tree, so that README.md's links to pages and pictures hold.
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program
  FILES_MATCHING PATTERN "*.cc" PATTERN "*.py")
install(DIRECTORY experiments DESTINATION ${CMAKE_INSTALL_DATADIR}/sextant COMPONENT program
  FILES_MATCHING PATTERN "*.yaml")
