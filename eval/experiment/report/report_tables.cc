// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/text/escape.h"
#include "base/text/printable.h"
#include "eval/experiment/report/rank_table.h"
#include "eval/experiment/report/report.h"

namespace sextant {
namespace {

std::string FigureText(const Statistic& statistic, const Figure& figure, bool with_interval) {
  // A figure over the answered trials alone states how many these are: a solver that answers only
  // the easy ones looks better.
  const std::string share = figure.trials < figure.all_trials
                                ? fmt::format(" ({}/{})", figure.trials, figure.all_trials)
                                : std::string();
  if (!std::isfinite(figure.value)) return "-" + share;
  const bool is_rate = statistic.kind == Statistic::Kind::kRate;
  const double scale = is_rate ? 100.0 : 1.0;
  const int decimals = is_rate ? std::min(statistic.decimals, 1) : statistic.decimals;
  std::string text = Fixed(scale * figure.value, decimals);
  if (is_rate) text += " %";
  if (!with_interval || !figure.interval) return text + share;
  return text + fmt::format(" [{}, {}]{}", Fixed(scale * figure.interval->low, decimals),
                            Fixed(scale * figure.interval->high, decimals), share);
}

std::string TitleOf(const TableSpec& spec, const std::string& place) {
  return spec.title + (spec.title.empty() || place.empty() ? "" : ": ") + place;
}

std::vector<std::string> RowOf(const TableSpec& spec, const ReportData& data, std::size_t condition,
                               std::size_t cell, std::string name) {
  std::vector<std::string> row = {std::move(name)};
  for (const Statistic& column : spec.columns) {
    row.push_back(FigureText(column, data.figures(condition, column)[cell], spec.intervals));
  }
  return row;
}

std::vector<std::string> HeaderOf(const TableSpec& spec, const char* first) {
  std::vector<std::string> header = {first};
  for (const Statistic& column : spec.columns) header.push_back(column.label);
  return header;
}

// One table for all conditions if each has one row, else one table per condition.
void AddPlainTables(const Experiment& experiment, const TableSpec& spec, const ReportData& data,
                    std::vector<ReportTable>& tables) {
  const std::size_t count = experiment.conditions.size();
  bool one_row_each = count > 1;
  for (std::size_t c = 0; c < count; ++c) one_row_each = one_row_each && data.cells(c).size() == 1;
  if (one_row_each) {
    TextTable table(HeaderOf(spec, "condition"));
    for (std::size_t c = 0; c < count; ++c) {
      table.AddRow(RowOf(spec, data, c, 0, PlaceWithout(experiment, experiment.conditions[c], "")));
    }
    tables.push_back({spec.title, std::move(table)});
    return;
  }
  for (std::size_t c = 0; c < count; ++c) {
    const Condition& condition = experiment.conditions[c];
    TextTable table(HeaderOf(spec, ""));
    for (std::size_t cell = 0; cell < data.cells(c).size(); ++cell) {
      table.AddRow(RowOf(spec, data, c, cell, SubjectText(condition, data.cells(c)[cell])));
    }
    tables.push_back({TitleOf(spec, PlaceWithout(experiment, condition, "")), std::move(table)});
  }
}

// One table per condition: the subjects by their ranks.
void AddRankTables(const Experiment& experiment, const TableSpec& spec, const ReportData& data,
                   std::vector<ReportTable>& tables) {
  for (std::size_t c = 0; c < experiment.conditions.size(); ++c) {
    const Condition& condition = experiment.conditions[c];
    std::vector<std::string> names;
    for (const CellKey& cell : data.cells(c)) names.push_back(SubjectText(condition, cell));
    tables.push_back({TitleOf(spec, PlaceWithout(experiment, condition, "")),
                      RankTable(names, data.values(c, spec.ranked))});
  }
}

// One row per subject and one column per value of an axis; one table for each combination of values
// on the other axes.
void AddTablesAcross(const Experiment& experiment, const TableSpec& spec, const ReportData& data,
                     std::vector<ReportTable>& tables) {
  std::vector<std::string> places;
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t c = 0; c < experiment.conditions.size(); ++c) {
    const std::string place = PlaceWithout(experiment, experiment.conditions[c], spec.across);
    const auto found = std::find(places.begin(), places.end(), place);
    if (found == places.end()) {
      places.push_back(place);
      groups.push_back({c});
    } else {
      groups[static_cast<std::size_t>(found - places.begin())].push_back(c);
    }
  }
  const auto axis = static_cast<std::size_t>(
      std::find(experiment.axes.begin(), experiment.axes.end(), spec.across) -
      experiment.axes.begin());
  const Statistic& statistic = spec.columns.front();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<std::string> header = {spec.across};
    std::vector<std::vector<std::string>> rows;
    for (const std::size_t c : groups[g]) {
      const Condition& condition = experiment.conditions[c];
      for (std::size_t cell = 0; cell < data.cells(c).size(); ++cell) {
        const std::string name = SubjectText(condition, data.cells(c)[cell]);
        auto row = std::find_if(rows.begin(), rows.end(),
                                [&name](const auto& r) { return r.front() == name; });
        if (row == rows.end()) row = rows.insert(rows.end(), {name});
        row->resize(header.size(), "-");
        row->push_back(FigureText(statistic, data.figures(c, statistic)[cell], spec.intervals));
      }
      header.push_back(condition.place[axis]);
    }
    TextTable table(header);
    for (std::vector<std::string>& row : rows) {
      row.resize(header.size(), "-");
      table.AddRow(std::move(row));
    }
    tables.push_back({TitleOf(spec, places[g]), std::move(table)});
  }
}

}  // namespace

std::vector<ReportTable> MakeTables(const Experiment& experiment, const ReportData& data) {
  std::vector<ReportTable> tables;
  for (const TableSpec& spec : experiment.tables) {
    if (spec.ranked >= 0) {
      AddRankTables(experiment, spec, data, tables);
    } else if (spec.across.empty()) {
      AddPlainTables(experiment, spec, data, tables);
    } else {
      AddTablesAcross(experiment, spec, data, tables);
    }
  }
  return tables;
}

namespace {

// The paragraphs of the experiment's text.
std::string MarkdownLines(const std::string& text) {
  std::string lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines += MarkdownText(line) + "\n";
  return lines;
}

}  // namespace

std::string ReportOrigin(const Experiment& experiment) {
  return fmt::format("Written by `sextant run` from the experiment `{}`:", experiment.name);
}

std::string FormatMarkdown(const Experiment& experiment, const ReportData& data) {
  std::string text = fmt::format("# {}\n\n", MarkdownText(experiment.title));
  if (!experiment.text.empty()) text += MarkdownLines(experiment.text) + "\n";
  text += fmt::format(
      "{} {} trials per condition, seed {}. In brackets: 95 percent "
      "intervals; (n/N): only n of N trials have the figure.\n",
      ReportOrigin(experiment), experiment.trials, experiment.seed);
  if (!experiment.absent.empty()) text += "\nNot run, because data is absent:\n\n";
  for (const std::string& line : experiment.absent) text += "- " + MarkdownText(line) + "\n";
  for (const ReportTable& table : MakeTables(experiment, data)) {
    if (!table.title.empty()) text += fmt::format("\n## {}\n", MarkdownText(table.title));
    text += "\n" + table.table.Markdown();
  }
  for (const PlotSpec& plot : experiment.plots) {
    if (PlotCommands(experiment, plot, data).empty()) continue;
    text += fmt::format("\n![{}]({}.svg)\n",
                        MarkdownText(plot.title.empty() ? plot.name : plot.title), plot.name);
  }
  return text;
}

std::string FormatPlain(const Experiment& experiment, const ReportData& data) {
  std::string text;
  for (const ReportTable& table : MakeTables(experiment, data)) {
    if (!text.empty()) text += "\n";
    if (!table.title.empty()) text += PrintableLine(table.title) + "\n";
    text += table.table.Plain();
  }
  for (const std::string& line : experiment.absent) {
    text += "not run: " + PrintableLine(line) + "\n";
  }
  return text;
}

std::string FormatLatex(const Experiment& experiment, const ReportData& data) {
  std::string text =
      fmt::format("% Written by sextant run from the experiment {}.\n", experiment.name);
  for (const ReportTable& table : MakeTables(experiment, data)) {
    text += fmt::format("\n% {}\n{}", PrintableLine(table.title), table.table.Latex());
  }
  return text;
}

}  // namespace sextant
