// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text/escape.h"
#include "base/version.h"
#include "eval/experiment/report/description.h"
#include "eval/experiment/report/report.h"
#include "eval/experiment/run/run_trials.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

Json NumberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json ToJson(const Figure& figure) {
  Json json = {{"value", NumberOrNull(figure.value)}};
  if (figure.interval) json["interval"] = {figure.interval->low, figure.interval->high};
  json["trials"] = figure.trials;
  json["all_trials"] = figure.all_trials;
  return json;
}

Json ToJson(const Description& values) {
  Json json = {{"count", values.count()}, {"missing", values.missing()}};
  if (values.count() == 0) return json;
  json["mean"] = NumberOrNull(values.mean());
  json["sd"] = NumberOrNull(values.sd());
  json["rms"] = NumberOrNull(values.rms());
  constexpr std::array kNames = {"min", "p05", "p25", "median", "p75", "p95", "max"};
  static_assert(kNames.size() == Description::kQuantiles.size());
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    json[kNames[i]] = NumberOrNull(values.Quantile(Description::kQuantiles[i]));
  }
  const Interval interval = values.MedianInterval();
  json["median_interval"] = {NumberOrNull(interval.low), NumberOrNull(interval.high)};
  return json;
}

// The metric's description in each cell.
Expected<std::vector<Description>> Describe(const ConditionRows& rows, int metric) {
  std::vector<Description> cells(rows.cells().size());
  ColumnPasses passes(rows, {metric});
  for (int pass = 0; pass < Description::kPasses; ++pass) {
    const Expected<void> ok = passes.Pass([&cells](const ColumnPasses::Rows& some) {
      for (std::size_t row = 0; row < some.cells.size(); ++row) {
        cells[some.cells[row]].Add(some.columns[0][row]);
      }
    });
    if (!ok) return tl::unexpected<Error>(ok.error());
    for (Description& cell : cells) cell.EndPass();
  }
  return cells;
}

// Descriptions of all wanted metrics by cell; empty for the others.
Expected<std::vector<std::vector<Description>>> DescribeAll(const Experiment& experiment,
                                                            const ConditionRows& rows) {
  std::vector<Expected<std::vector<Description>>> described(experiment.metrics.size());
  tbb::parallel_for(std::size_t{0}, described.size(), [&](std::size_t metric) {
    if (experiment.wanted[metric]) described[metric] = Describe(rows, static_cast<int>(metric));
  });
  std::vector<std::vector<Description>> all;
  for (Expected<std::vector<Description>>& of_metric : described) {
    if (!of_metric) return tl::unexpected<Error>(std::move(of_metric.error()));
    all.push_back(std::move(*of_metric));
  }
  return all;
}

Json ReportFigures(const Experiment& experiment, const ReportData& data, std::size_t condition,
                   std::size_t cell) {
  Json figures = Json::object();
  const auto add = [&](const Statistic& statistic) {
    figures[statistic.text] = ToJson(data.figures(condition, statistic)[cell]);
  };
  for (const TableSpec& table : experiment.tables) {
    for (const Statistic& column : table.columns) add(column);
  }
  for (const PlotSpec& plot : experiment.plots) {
    if (plot.metric < 0) add(plot.y);
  }
  return figures;
}

Json DescribeCondition(const Experiment& experiment, const Condition& condition) {
  Json json = {{"name", condition.name}};
  for (std::size_t i = 0; i < experiment.axes.size(); ++i) {
    json["place"][experiment.axes[i]] = condition.place[i];
  }
  for (const auto& [name, value] : condition.parameters) json["parameters"][name] = value;
  return json;
}

}  // namespace

Expected<std::string> FormatSummary(const Experiment& experiment, const RowFileReader& reader,
                                    const ReportData& data) {
  Json json = {{"sextant", Version()},      {"experiment", experiment.name},
               {"title", experiment.title}, {"kind", experiment.kind},
               {"seed", experiment.seed},   {"trials", experiment.trials}};
  for (std::size_t m = 0; m < experiment.metrics.size(); ++m) {
    if (experiment.wanted[m])
      json["metrics"][experiment.metrics[m].name] = experiment.metrics[m].meaning;
  }
  for (std::size_t c = 0; c < experiment.conditions.size(); ++c) {
    const Condition& condition = experiment.conditions[c];
    SEXTANT_ASSIGN_OR_RETURN(const ConditionRows rows, ConditionRows::Open(experiment, reader, c));
    Json cells = Json::array();
    for (std::size_t i = 0; i < rows.cells().size(); ++i) {
      const CellKey& cell = rows.cells()[i];
      cells.push_back(
          {{"subject", condition.trials->subjects()[static_cast<std::size_t>(cell.subject)]},
           {"index", cell.index},
           {"metrics", Json::object()},
           {"figures", ReportFigures(experiment, data, c, i)}});
    }
    SEXTANT_ASSIGN_OR_RETURN(const std::vector<std::vector<Description>> descriptions,
                             DescribeAll(experiment, rows));
    for (std::size_t m = 0; m < experiment.metrics.size(); ++m) {
      if (!experiment.wanted[m]) continue;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        cells[i]["metrics"][experiment.metrics[m].name] = ToJson(descriptions[m][i]);
      }
    }
    Json described = DescribeCondition(experiment, condition);
    described["cells"] = std::move(cells);
    json["conditions"].push_back(std::move(described));
  }
  return JsonText(json, 1);
}

}  // namespace sextant
