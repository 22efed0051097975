// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/page/page.h"

namespace sextant {

/// The photo with the scan and both outlines of each board over it, and a legend; empty without a
/// photo.
std::string PhotoHtml(const PageView& view);

/// The outlines of all boards on the frame of a camera's image.
std::string CoverageHtml(const PageCoverage& coverage);

}  // namespace sextant
