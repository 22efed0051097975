// SPDX-License-Identifier: Apache-2.0
#include "base/random.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace sextant {
namespace {

std::uint64_t SplitMix64(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

// std::log may differ in its last bit between C libraries; frexp and the series do not.
double PortableLog(double x) {
  constexpr double kLn2 = 0.693147180559945309417232121458;
  constexpr double kSqrtHalf = 0.707106781186547524400844362105;
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);
  if (mantissa < kSqrtHalf) {
    mantissa *= 2.0;
    --exponent;
  }
  // log(m) = 2 atanh((m-1)/(m+1)), |argument| < 0.172: 11 terms reach 1e-18.
  const double z = (mantissa - 1.0) / (mantissa + 1.0);
  const double z2 = z * z;
  double sum = 0.0;
  for (int k = 21; k >= 1; k -= 2) sum = sum * z2 + 1.0 / k;
  return 2.0 * z * sum + exponent * kLn2;
}

template <std::size_t kTerms>
double Polynomial(const std::array<double, kTerms>& coefficients, double x) {
  double value = coefficients.back();
  for (std::size_t i = kTerms - 1; i-- > 0;) value = value * x + coefficients[i];
  return value;
}

// Quantile of the standard normal; coefficients of AS241 (PPND16), lowest order first.
double NormalQuantile(double p) {
  constexpr std::array<double, 8> kCentreNum = {3.3871328727963666080e0, 1.3314166789178437745e2,
                                                1.9715909503065514427e3, 1.3731693765509461125e4,
                                                4.5921953931549871457e4, 6.7265770927008700853e4,
                                                3.3430575583588128105e4, 2.5090809287301226727e3};
  constexpr std::array<double, 8> kCentreDen = {1.0,
                                                4.2313330701600911252e1,
                                                6.8718700749205790830e2,
                                                5.3941960214247511077e3,
                                                2.1213794301586595867e4,
                                                3.9307895800092710610e4,
                                                2.8729085735721942674e4,
                                                5.2264952788528545610e3};
  constexpr std::array<double, 8> kMiddleNum = {
      1.42343711074968357734e0,  4.63033784615654529590e0, 5.76949722146069140550e0,
      3.64784832476320460504e0,  1.27045825245236838258e0, 2.41780725177450611770e-1,
      2.27238449892691845833e-2, 7.74545014278341407640e-4};
  constexpr std::array<double, 8> kMiddleDen = {1.0,
                                                2.05319162663775882187e0,
                                                1.67638483018380384940e0,
                                                6.89767334985100004550e-1,
                                                1.48103976427480074590e-1,
                                                1.51986665636164571966e-2,
                                                5.47593808499534494600e-4,
                                                1.05075007164441684324e-9};
  constexpr std::array<double, 8> kTailNum = {6.65790464350110377720e0,  5.46378491116411436990e0,
                                              1.78482653991729133580e0,  2.96560571828504891230e-1,
                                              2.65321895265761230930e-2, 1.24266094738807843860e-3,
                                              2.71155556874348757815e-5, 2.01033439929228813265e-7};
  constexpr std::array<double, 8> kTailDen = {1.0,
                                              5.99832206555887937690e-1,
                                              1.36929880922735805310e-1,
                                              1.48753612908506148525e-2,
                                              7.86869131145613259100e-4,
                                              1.84631831751005468180e-5,
                                              1.42151175831644588870e-7,
                                              2.04426310338993978564e-15};
  const double q = p - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * Polynomial(kCentreNum, r) / Polynomial(kCentreDen, r);
  }
  const double tail = std::sqrt(-PortableLog(q < 0.0 ? p : 1.0 - p));
  const double magnitude =
      tail <= 5.0 ? Polynomial(kMiddleNum, tail - 1.6) / Polynomial(kMiddleDen, tail - 1.6)
                  : Polynomial(kTailNum, tail - 5.0) / Polynomial(kTailDen, tail - 5.0);
  return q < 0.0 ? -magnitude : magnitude;
}

}  // namespace

Random::Random(std::uint64_t seed) {
  for (std::uint64_t& word : state_) word = SplitMix64(seed);
}

std::uint64_t Random::Bits() {
  const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::Uniform() { return static_cast<double>(Bits() >> 11) * 0x1.0p-53; }

double Random::Uniform(double low, double high) { return low + (high - low) * Uniform(); }

std::uint64_t Random::Below(std::uint64_t count) {
  assert(count > 0);
  // Rejects the incomplete last block, so that every index is equally likely.
  const std::uint64_t rejected = (0 - count) % count;
  std::uint64_t bits = Bits();
  while (bits < rejected) bits = Bits();
  return bits % count;
}

double Random::Normal() {
  // The half step keeps both ends open: the quantile of 0 is infinite.
  const double p = (static_cast<double>(Bits() >> 12) + 0.5) * 0x1.0p-52;
  return NormalQuantile(p);
}

void Random::Sample(int count, std::span<int> sample) {
  assert(static_cast<int>(sample.size()) <= count);
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const auto drawn = sample.first(i);
    do {
      sample[i] = static_cast<int>(Below(static_cast<std::uint64_t>(count)));
    } while (std::find(drawn.begin(), drawn.end(), sample[i]) != drawn.end());
  }
}

std::uint64_t DeriveSeed(std::uint64_t suite_seed, std::string_view experiment,
                         std::uint64_t case_index, std::uint64_t trial) {
  std::uint64_t state = 0;
  const auto mix = [&state](std::uint64_t value) {
    state ^= value;
    state = SplitMix64(state);
  };
  mix(suite_seed);
  for (const char c : experiment) mix(static_cast<unsigned char>(c));
  mix(experiment.size());
  mix(case_index);
  mix(trial);
  return state;
}

}  // namespace sextant
