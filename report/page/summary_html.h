// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/page/page.h"

namespace sextant {

/// Title, verdict and the figures below it: what a reader needs who reads no further.
std::string SummaryHtml(const ReportPage& page);

/// A transform in words, and in numbers in both directions.
std::string TransformHtml(const PageTransform& transform);

/// The correlations as a table, coloured by sign and strength; the numbers are written, too.
std::string CorrelationHtml(const PageCorrelation& correlation);

}  // namespace sextant
