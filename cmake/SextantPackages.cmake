# SPDX-License-Identifier: Apache-2.0
# `cpack -G DEB`: sextant (program, pages, scenes, experiments), libsextant-dev, python3-sextant and
# sextant-mpi. scripts/packages builds them, scripts/bare-package proves them on a bare Debian.
set(CPACK_PACKAGE_NAME sextant)
set(CPACK_PACKAGE_VENDOR sextant)
set(CPACK_PACKAGE_CONTACT "sextant developers <sextant@users.noreply.example>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE zstd)
set(CPACK_COMPONENTS_ALL program development)

# dpkg-shlibdeps does not see the library of image formats, which is opened at first use (io/images).
set(opened_libraries "")
if(SEXTANT_LAZY_IMAGE_FORMATS)
  get_target_property(configurations opencv_imgcodecs IMPORTED_CONFIGURATIONS)
  list(GET configurations 0 configuration)
  get_target_property(soname opencv_imgcodecs IMPORTED_SONAME_${configuration})
  execute_process(COMMAND dpkg-query -S "*/${soname}" OUTPUT_VARIABLE owner ERROR_QUIET)
  if(owner MATCHES "^([^:, ]+)")
    set(opened_libraries ${CMAKE_MATCH_1})
  endif()
endif()

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME sextant)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS ${opened_libraries})
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "LiDAR-camera calibration and comparison of its solvers
 The program, its pages, scenes and experiments.")

# A static library needs what its users link: every library of scripts/packages.txt.
file(STRINGS ${PROJECT_SOURCE_DIR}/scripts/packages.txt lines REGEX "^library +[^ ]+-dev ")
set(library_packages g++ cmake pkg-config)
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^library +([^ ]+) .*$" "\\1" package "${line}")
  list(APPEND library_packages ${package})
endforeach()
list(JOIN library_packages ", " library_packages)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libsextant-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ${library_packages})
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "LiDAR-camera calibration: C++ libraries
 Headers, static libraries and files for CMake's find_package(sextant).")

if(SEXTANT_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-sextant)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  list(JOIN opened_libraries ", " python_depends)
  string(PREPEND python_depends "python3 (>= 3.${Python_VERSION_MINOR}), \
python3 (<< 3.${next_minor}), python3-numpy, ")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS ${python_depends})
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS sextant)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "LiDAR-camera calibration: Python module
 Solvers, calibration, simulation and experiments for numpy.")
endif()
if(SEXTANT_MPI)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
  set(CPACK_DEBIAN_MPI_PACKAGE_NAME sextant-mpi)
  set(CPACK_DEBIAN_MPI_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_MPI_PACKAGE_RECOMMENDS openmpi-bin)
  set(CPACK_COMPONENT_MPI_DESCRIPTION "LiDAR-camera calibration: experiments on many machines
 Runs the experiments of sextant by MPI.")
endif()
include(CPack)
