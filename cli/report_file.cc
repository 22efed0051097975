// SPDX-License-Identifier: Apache-2.0
#include "cli/report_file.h"

#include <utility>

#include "io/output/output_file.h"
#include "report/collect/utc_text.h"
#include "report/page/page_html.h"

namespace sextant::cli {

Expected<void> WriteReport(PageSource source, const std::filesystem::path& path) {
  source.written = TodayText();
  return WriteFileAtomically(path, FormatPage(CollectPage(source)));
}

}  // namespace sextant::cli
