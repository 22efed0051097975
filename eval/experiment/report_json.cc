// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/version.h"
#include "eval/experiment/report.h"
#include "eval/experiment/run_trials.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

Json NumberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json ToJson(const Figure& figure) {
  Json json = {{"value", NumberOrNull(figure.value)}};
  if (figure.interval) json["interval"] = {figure.interval->low, figure.interval->high};
  json["trials"] = figure.trials;
  return json;
}

Json DescribeValues(std::vector<double> values) {
  const std::size_t rows = values.size();
  std::erase_if(values, [](double v) { return std::isnan(v); });
  Json json = {{"count", values.size()}, {"missing", rows - values.size()}};
  if (values.empty()) return json;
  double sum = 0.0;
  double squares = 0.0;
  for (const double v : values) sum += v;
  const double mean = sum / static_cast<double>(values.size());
  double deviations = 0.0;
  for (const double v : values) {
    squares += v * v;
    deviations += (v - mean) * (v - mean);
  }
  const auto count = static_cast<double>(values.size());
  json["mean"] = NumberOrNull(mean);
  json["sd"] = NumberOrNull(std::sqrt(deviations / count));
  json["rms"] = NumberOrNull(std::sqrt(squares / count));
  std::sort(values.begin(), values.end());
  json["min"] = NumberOrNull(values.front());
  for (const auto& [name, q] :
       {std::pair{"p05", 0.05}, std::pair{"p25", 0.25}, std::pair{"median", 0.5},
        std::pair{"p75", 0.75}, std::pair{"p95", 0.95}}) {
    json[name] = NumberOrNull(QuantileOfSorted(values, q));
  }
  json["max"] = NumberOrNull(values.back());
  const Interval interval = QuantileInterval(values, 0.5);
  json["median_interval"] = {NumberOrNull(interval.low), NumberOrNull(interval.high)};
  return json;
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
  for (const PlotSpec& plot : experiment.plots) add(plot.y);
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
    const Expected<ConditionRows> rows = ConditionRows::Open(experiment, reader, c);
    if (!rows) return tl::unexpected<Error>(rows.error());
    Json cells = Json::array();
    for (std::size_t i = 0; i < rows->cells().size(); ++i) {
      const CellKey& cell = rows->cells()[i];
      cells.push_back(
          {{"subject", condition.trials->subjects()[static_cast<std::size_t>(cell.subject)]},
           {"index", cell.index},
           {"metrics", Json::object()},
           {"figures", ReportFigures(experiment, data, c, i)}});
    }
    for (std::size_t m = 0; m < experiment.metrics.size(); ++m) {
      if (!experiment.wanted[m]) continue;
      Expected<std::vector<std::vector<double>>> column = rows->Column(static_cast<int>(m));
      if (!column) return tl::unexpected<Error>(column.error());
      for (std::size_t i = 0; i < cells.size(); ++i) {
        cells[i]["metrics"][experiment.metrics[m].name] = DescribeValues(std::move((*column)[i]));
      }
    }
    Json described = DescribeCondition(experiment, condition);
    described["cells"] = std::move(cells);
    json["conditions"].push_back(std::move(described));
  }
  return json.dump(1) + "\n";
}

}  // namespace sextant
