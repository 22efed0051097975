// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/page/page.h"

namespace sextant {

/// The table of all views, the 3D view with its controls, and a card for each view: photo, outlines
/// and residuals per corner. Without JavaScript every card is shown, and a view from above.
std::string ViewsHtml(const ReportPage& page, bool has_3d);

}  // namespace sextant
