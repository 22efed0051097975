// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/page/page.h"

namespace sextant {

/// The report as one file of HTML: it loads nothing, and its tables and pictures need no
/// JavaScript. The same content gives the same bytes. Time and memory are linear in the content.
std::string FormatPage(const ReportPage& page);

}  // namespace sextant
