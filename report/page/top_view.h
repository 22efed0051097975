// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/page/page.h"

namespace sextant {

/// The sensors, the boards of all views and the returns of one scan from above: what the 3D view
/// shows, for readers without JavaScript or WebGL, and for paper.
std::string TopViewHtml(const ReportPage& page);

}  // namespace sextant
