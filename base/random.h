// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace sextant {

/// Portable random numbers: the same seed gives the same bits on every platform and compiler.
///
/// Generator: xoshiro256++ (Blackman and Vigna 2021), seeded through splitmix64. The standard
/// library's distributions differ between implementations; the distributions here use only
/// operations that IEEE 754 rounds exactly.
/// Draw once per statement: the order of evaluation of function arguments is not portable.
class Random {
 public:
  explicit Random(std::uint64_t seed);

  std::uint64_t Bits();

  /// In [0, 1), a multiple of 2^-53.
  double Uniform();

  /// In [low, high).
  double Uniform(double low, double high);

  /// In [0, count), without bias. Requires count > 0.
  std::uint64_t Below(std::uint64_t count);

  /// Standard normal by inversion of the distribution function (Wichura 1988, AS241, 1e-16).
  double Normal();

  /// Fills `sample` with distinct indices in [0, count), in the order drawn. Allocates nothing.
  /// Requires sample.size() <= count.
  void Sample(int count, std::span<int> sample);

 private:
  std::array<std::uint64_t, 4> state_;
};

/// The seed of one trial: a hash of experiment, case and trial, so that it depends neither on the
/// thread or rank that runs it nor on how many trials ran before.
std::uint64_t DeriveSeed(std::uint64_t suite_seed, std::string_view experiment,
                         std::uint64_t case_index, std::uint64_t trial);

}  // namespace sextant
