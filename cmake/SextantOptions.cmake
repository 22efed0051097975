# SPDX-License-Identifier: Apache-2.0
# Language, warnings and sanitizers of our own targets; users of the libraries do not inherit them.
# Newer compilers have more warnings. Warnings are errors only with the compilers that we test.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13
   OR CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 15)
  set(known_compiler ON)
else()
  set(known_compiler OFF)
endif()
option(SEXTANT_WARNINGS_AS_ERRORS "Fail the build on a warning" ${known_compiler})
option(SEXTANT_OPENCV "Build what needs OpenCV: cameras, simulator, program and tests; off: only the other libraries" ON)
option(SEXTANT_BENCH "Build the benchmarks" ON)
option(SEXTANT_ROSBAG_ORACLE "Compare our ROS 1 bags with librosbag-storage in the tests" OFF)
option(SEXTANT_FUZZ "Build the fuzz targets (clang)" OFF)
option(SEXTANT_NATIVE "Compile for the building machine; the result does not run on a lesser one" OFF)
set(SEXTANT_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined")

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

# -O3 pays in geometry and in the inner loops of solvers (kernels, least_squares, pnp, robust), which
# set it: with -O2 they take up to 89 percent more instructions. Elsewhere it costs build time.
if(CMAKE_CXX_FLAGS_RELEASE STREQUAL "-O3 -DNDEBUG")
  set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG" CACHE STRING "Flags of a release build" FORCE)
endif()

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

add_library(sextant_options INTERFACE)
target_compile_options(sextant_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wnon-virtual-dtor -Wold-style-cast
  # g++ 12 has a false warning about `"text" + string` (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  # Fused multiply-add would round differently from machine to machine: same seed, same bits.
  -ffp-contract=off
  # Neither errno nor traps are used: square roots become one instruction, and both sides of a
  # selection may be computed. No result changes.
  -fno-math-errno -fno-trapping-math
  # Wide vectors (base/simd.h) are never passed to a function that is not inlined.
  -Wno-psabi
  $<$<BOOL:${SEXTANT_WARNINGS_AS_ERRORS}>:-Werror>)
if(SEXTANT_NATIVE)
  # Eigen's alignment depends on the instruction set, and its types are passed to Debian's libraries,
  # which are built for SSE2. These definitions keep its layouts and its allocator compatible.
  target_compile_options(sextant_options INTERFACE -march=native
    # g++ 12 reports the undefined registers of its own AVX-512 header as uninitialised variables, and
    # Eigen's packets of eight doubles as reads beyond small matrices, in branches that never run.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-uninitialized -Wno-array-bounds>)
  target_compile_definitions(sextant_options INTERFACE
    EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MAX_STATIC_ALIGN_BYTES=16)
endif()
if(SEXTANT_SANITIZE)
  target_compile_definitions(sextant_options INTERFACE SEXTANT_SANITIZED)
  target_compile_options(sextant_options INTERFACE
    -fsanitize=${SEXTANT_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer
    # g++ 12 reports optional members of moved values as uninitialised in instrumented code, and
    # the fences of Boost's Asio, which the thread sanitizer does not see.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-tsan>)
  target_link_options(sextant_options INTERFACE -fsanitize=${SEXTANT_SANITIZE})
endif()
if(SEXTANT_FUZZ)
  target_compile_options(sextant_options INTERFACE -fsanitize=fuzzer-no-link)
endif()
