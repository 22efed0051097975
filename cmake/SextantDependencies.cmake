# SPDX-License-Identifier: Apache-2.0
# scripts/packages.txt lists every library with its Debian package and its purpose. Each version is the
# oldest that works; newer major versions of fmt, Ceres and OpenCV pass these checks.

# find_package for a library that our static libraries link. If it was found, sextantConfig.cmake finds
# it too, for projects that call find_package(sextant).
macro(sextant_dependency package)
  find_package(${package} ${ARGN})
  if(${package}_FOUND)
    string(JOIN " " arguments ${package} ${ARGN})
    string(APPEND SEXTANT_FIND_DEPENDENCIES "find_dependency(${arguments})
")
  endif()
endmacro()

sextant_dependency(Eigen3 3.4 REQUIRED NO_MODULE)
sextant_dependency(tl-expected REQUIRED)
sextant_dependency(fmt 9 REQUIRED)
# Its headers alone.
sextant_dependency(Boost 1.74 REQUIRED CONFIG)
sextant_dependency(Ceres 2.1 REQUIRED)
sextant_dependency(nanoflann REQUIRED)
sextant_dependency(yaml-cpp REQUIRED)
sextant_dependency(nlohmann_json REQUIRED)
sextant_dependency(tinyxml2 REQUIRED)
if(SEXTANT_OPENCV)
  # ArUco is a contributed module up to OpenCV 4.6 and part of objdetect from 4.7 on.
  find_package(OpenCV 4.5 REQUIRED COMPONENTS core)
  if(OpenCV_VERSION VERSION_LESS 4.7)
    set(SEXTANT_OPENCV_ARUCO aruco)
  else()
    set(SEXTANT_OPENCV_ARUCO objdetect)
  endif()
  sextant_dependency(OpenCV 4.5 REQUIRED COMPONENTS
    core imgproc imgcodecs calib3d ${SEXTANT_OPENCV_ARUCO})
  sextant_dependency(apriltag 3.2 REQUIRED)
  sextant_dependency(TBB REQUIRED)
endif()
# liblzf has no CMake package, only a pkg-config file.
sextant_dependency(PkgConfig REQUIRED)
pkg_check_modules(LZF REQUIRED IMPORTED_TARGET liblzf)
string(APPEND SEXTANT_FIND_DEPENDENCIES "pkg_check_modules(LZF REQUIRED IMPORTED_TARGET liblzf)\n")
if(SEXTANT_OPENCV)
  find_package(CLI11 REQUIRED)
  # Draws boards to print.
  pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)
  # Names the inputs of a report.
  pkg_check_modules(SHA REQUIRED IMPORTED_TARGET libmd)
  # For the program only: highgui maps over a hundred shared objects into a process.
  find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc imgcodecs highgui)
endif()

# ROS recordings are optional. lz4 and zstd are found by their linker names, because not every
# distribution has CMake files for them.
option(SEXTANT_BAG "Read and write ROS recordings (sextant::bag) if the libraries are found" ON)
if(SEXTANT_BAG)
  find_package(BZip2 QUIET)
  find_package(SQLite3 QUIET)
  find_library(SEXTANT_LZ4 lz4)
  find_library(SEXTANT_ZSTD zstd)
  find_path(SEXTANT_LZ4_INCLUDE lz4frame.h)
  find_path(SEXTANT_ZSTD_INCLUDE zstd.h)
  mark_as_advanced(SEXTANT_LZ4 SEXTANT_ZSTD SEXTANT_LZ4_INCLUDE SEXTANT_ZSTD_INCLUDE)
  if(BZIP2_FOUND AND SQLite3_FOUND AND SEXTANT_LZ4 AND SEXTANT_ZSTD AND SEXTANT_LZ4_INCLUDE
     AND SEXTANT_ZSTD_INCLUDE)
    string(APPEND SEXTANT_FIND_DEPENDENCIES "find_dependency(BZip2)
find_dependency(SQLite3)
")
  else()
    message(STATUS "bz2, lz4, zstd or SQLite not found: no ROS recordings")
    set(SEXTANT_BAG OFF)
  endif()
endif()

# Experiments on many machines are optional.
option(SEXTANT_MPI "Build sextant-mpi if MPI is found" ON)
if(SEXTANT_MPI AND SEXTANT_OPENCV)
  find_package(MPI QUIET COMPONENTS CXX)
  if(NOT MPI_CXX_FOUND)
    message(STATUS "MPI not found: no sextant-mpi")
    set(SEXTANT_MPI OFF)
  endif()
else()
  set(SEXTANT_MPI OFF)
endif()

# The Python module is optional, and for the system's Python, whose numpy and pybind11 it uses. The
# sanitizers would have to be loaded before Python.
option(SEXTANT_PYTHON "Build the Python module if pybind11 is found" ON)
if(SEXTANT_PYTHON AND SEXTANT_OPENCV AND NOT SEXTANT_SANITIZE)
  set(Python_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "The Python that the module is for")
  find_package(Python 3.9 QUIET COMPONENTS Interpreter Development.Module NumPy)
  if(Python_FOUND)
    find_package(pybind11 2.10 QUIET CONFIG)
  endif()
  if(NOT pybind11_FOUND)
    message(STATUS "pybind11, numpy or Python's headers not found: no Python module")
    set(SEXTANT_PYTHON OFF)
  endif()
else()
  set(SEXTANT_PYTHON OFF)
endif()

# yaml-cpp 0.7 (Debian 12) exports its target without the namespace that 0.8 gives it.
if(NOT TARGET yaml-cpp::yaml-cpp)
  add_library(yaml-cpp::yaml-cpp ALIAS yaml-cpp)
endif()

if(BUILD_TESTING AND SEXTANT_OPENCV)
  find_package(GTest REQUIRED)
endif()
if(SEXTANT_BENCH AND SEXTANT_OPENCV)
  find_package(benchmark QUIET)
  if(NOT benchmark_FOUND)
    message(STATUS "Google Benchmark not found: no benchmarks")
    set(SEXTANT_BENCH OFF)
  endif()
endif()
