// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sextant {

/// The normal quantile that corresponds to an F-distributed quotient (Wilson and Hilferty 1931;
/// Paulson 1942). It is bounded for few degrees of the denominator: of three or four views, none
/// reaches 4 sigma.
double NormalOfF(double quotient, double freedom, double freedom_of_scale);

}  // namespace sextant
