// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace sextant {

/// Coefficients from the constant up.
template <std::size_t kTerms>
using Polynomial = std::array<double, kTerms>;

template <std::size_t kTerms>
double Value(const Polynomial<kTerms>& p, double x) {
  double sum = 0.0;
  for (std::size_t i = kTerms; i-- > 0;) sum = sum * x + p[i];
  return sum;
}

template <std::size_t kTerms>
double Slope(const Polynomial<kTerms>& p, double x) {
  double sum = 0.0;
  for (std::size_t i = kTerms; i-- > 1;) sum = sum * x + static_cast<double>(i) * p[i];
  return sum;
}

/// Whether the polynomial with these Bernstein coefficients is positive on its interval: it lies
/// between the smallest and the largest of them, which converge to it as the interval is halved.
/// Undecided after all halvings means that it touches zero.
template <std::size_t kTerms>
bool IsPositiveByHalving(Polynomial<kTerms> bernstein, int halvings) {
  if (!(bernstein.front() > 0.0 && bernstein.back() > 0.0)) return false;
  if (*std::min_element(bernstein.begin(), bernstein.end()) > 0.0) return true;
  if (halvings == 0) return false;
  Polynomial<kTerms> left;
  for (std::size_t level = 0; level < kTerms; ++level) {
    left[level] = bernstein[0];
    for (std::size_t i = 0; i + level + 1 < kTerms; ++i) {
      bernstein[i] = 0.5 * (bernstein[i] + bernstein[i + 1]);
    }
  }
  return IsPositiveByHalving(left, halvings - 1) && IsPositiveByHalving(bernstein, halvings - 1);
}

/// Whether p > 0 on all of [0, end]. Allocates nothing and needs no root search, so that the
/// domain of a camera is checked without a cache besides its coefficients.
template <std::size_t kTerms>
bool IsPositiveUpTo(const Polynomial<kTerms>& p, double end) {
  constexpr int kMaxHalvings = 30;
  Polynomial<kTerms> scaled;
  double power = 1.0;
  double lower_bound = p[0];
  for (std::size_t i = 0; i < kTerms; ++i) {
    scaled[i] = p[i] * power;
    if (i > 0) lower_bound += std::min(0.0, scaled[i]);
    power *= end;
  }
  if (lower_bound > 0.0) return true;
  // Bernstein coefficient i is sum_j C(i, j) / C(degree, j) scaled_j.
  Polynomial<kTerms> bernstein{};
  for (std::size_t i = 0; i < kTerms; ++i) {
    double ratio = 1.0;
    for (std::size_t j = 0; j <= i; ++j) {
      bernstein[i] += ratio * scaled[j];
      if (j < i) ratio *= static_cast<double>(i - j) / static_cast<double>(kTerms - 1 - j);
    }
  }
  return IsPositiveByHalving(bernstein, kMaxHalvings);
}

}  // namespace sextant
