// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "eval/experiment/definition/experiment.h"

namespace sextant {

/// The style of a plot's i-th line, for gnuplot: a colour, dashes and a marker that together differ
/// from those of the other lines, also in grey and where lines lie on each other: earlier lines are
/// wider and have larger markers, so that they show beside later ones.
std::string LineStyle(std::size_t i);

/// The settings of every plot: title, labels, logarithmic axes, grid, axes that begin with
/// the data, and the key outside.
std::string PlotFrame(const PlotSpec& plot, std::size_t longest_name);

}  // namespace sextant
