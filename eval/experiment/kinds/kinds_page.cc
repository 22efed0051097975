// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/kinds_page.h"

#include <fmt/core.h>

#include "eval/statistics/text_table.h"

namespace sextant {

std::string FormatKindsPage(const std::vector<TrialKind>& kinds) {
  std::string text;
  for (const TrialKind& kind : kinds) {
    text += fmt::format("{}### {}\n\n{}{}.\n\n", text.empty() ? "" : "\n", kind.name, kind.summary,
                        kind.takes_solvers ? "" : "; takes no solvers");
    TextTable parameters({"parameter", "default", "unit", "meaning"}, TextTable::Columns::kWords);
    for (const OptionDoc& doc : kind.parameters) {
      parameters.AddRow({"`" + doc.name + "`", doc.default_value, doc.unit, doc.meaning});
    }
    if (!kind.parameters.empty()) text += parameters.Markdown() + "\n";
    TextTable metrics({"metric", "meaning"}, TextTable::Columns::kWords);
    for (const Metric& metric : kind.metrics) {
      metrics.AddRow({"`" + metric.name + "`", metric.meaning});
    }
    text += metrics.Markdown();
  }
  return text;
}

}  // namespace sextant
