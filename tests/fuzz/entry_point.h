// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

// One definition for two programs: linked with libFuzzer (SEXTANT_LIBFUZZER) a target is the
// function that libFuzzer calls, one target a program; in the ordinary tests all targets are
// entries of one table, and the tests call them with the corpus.
namespace sextant::test {

/// Runs the code under test on an input. It throws (Fault) where the code breaks a promise;
/// libFuzzer then stores the input, and a test fails.
using FuzzTarget = void (*)(std::string_view bytes);

#ifndef SEXTANT_LIBFUZZER
/// All targets by name.
std::map<std::string, FuzzTarget>& FuzzTargets();

struct FuzzTargetEntry {
  FuzzTargetEntry(const char* name, FuzzTarget target) { FuzzTargets()[name] = target; }
};
#endif

}  // namespace sextant::test

/// Defines a target, in the namespace sextant::test of a file of its own:
/// SEXTANT_FUZZ_TARGET(pcd, bytes) { ... } gets the input as std::string_view bytes.
#ifdef SEXTANT_LIBFUZZER
#define SEXTANT_FUZZ_TARGET(name, bytes)                                              \
  static void Fuzz_##name(std::string_view bytes);                                    \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    Fuzz_##name({reinterpret_cast<const char*>(data), size});                         \
    return 0;                                                                         \
  }                                                                                   \
  static void Fuzz_##name(std::string_view bytes)
#else
#define SEXTANT_FUZZ_TARGET(name, bytes)                            \
  static void Fuzz_##name(std::string_view bytes);                  \
  static const FuzzTargetEntry entry_of_##name(#name, Fuzz_##name); \
  static void Fuzz_##name(std::string_view bytes)
#endif
