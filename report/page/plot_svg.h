// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/page/page.h"

namespace sextant {

/// A plot as a figure with an inline picture: each series has a colour and a mark of its own.
/// Points with a coordinate that is not finite, or not positive on a logarithmic axis, are omitted.
/// Empty where no point remains.
std::string PlotHtml(const PagePlot& plot);

}  // namespace sextant
