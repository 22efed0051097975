// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "report/page/page.h"

namespace sextant {

/// A section with a heading, which the contents of the page can name by its id.
std::string SectionHtml(std::string_view id, std::string_view title, std::string_view body);

/// A table with its note; the note alone where it has no rows.
std::string TableHtml(const PageTable& table);

/// A picture in the page, with a text for those who do not see it.
std::string PictureHtml(std::string_view type, std::string_view bytes, const std::string& text);

/// The number times `scale`, or a dash.
std::string NumberHtml(const std::optional<double>& value, double scale, int decimals);

}  // namespace sextant
