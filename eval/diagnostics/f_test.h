// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sextant {

/// The probability that F with `d1` and `d2` degrees of freedom exceeds `f` by chance. Exact for an
/// even d1 (otherwise that of the next larger one).
double TailOfF(double f, double d1, double d2);

}  // namespace sextant
