// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <set>

#include "eval/experiment/report/report.h"
#include "eval/experiment/report/trial_values.h"
#include "eval/experiment/run/run_trials.h"

namespace sextant {
namespace {

// All distinct statistics of the report.
std::vector<Statistic> StatisticsOf(const Experiment& experiment) {
  std::map<std::string, Statistic> by_text;
  for (const TableSpec& table : experiment.tables) {
    for (const Statistic& column : table.columns) by_text.emplace(column.text, column);
  }
  for (const PlotSpec& plot : experiment.plots) {
    if (plot.metric < 0) by_text.emplace(plot.y.text, plot.y);
  }
  std::vector<Statistic> statistics;
  for (auto& [text, statistic] : by_text) statistics.push_back(std::move(statistic));
  return statistics;
}

// All metrics of which the report shows single trials.
std::set<int> MetricsOfTrials(const Experiment& experiment) {
  std::set<int> metrics;
  for (const PlotSpec& plot : experiment.plots) metrics.insert(plot.metric);
  for (const TableSpec& table : experiment.tables) metrics.insert(table.ranked);
  metrics.erase(-1);
  return metrics;
}

}  // namespace

Expected<ReportData> ReportData::Compute(const Experiment& experiment,
                                         const RowFileReader& reader) {
  if (reader.configuration() != ConfigurationOf(experiment)) {
    return MakeError(ErrorCode::kInvalidInput,
                     "the rows belong to another configuration than that of the experiment file");
  }
  const std::vector<Statistic> statistics = StatisticsOf(experiment);
  ReportData data;
  for (std::size_t c = 0; c < experiment.conditions.size(); ++c) {
    SEXTANT_ASSIGN_OR_RETURN(const ConditionRows rows, ConditionRows::Open(experiment, reader, c));
    std::vector<Expected<std::vector<Figure>>> computed(statistics.size());
    tbb::parallel_for(std::size_t{0}, statistics.size(), [&](std::size_t i) {
      computed[i] = ComputeFigures(statistics[i], rows, experiment.seed);
    });
    std::map<std::string, std::vector<Figure>> figures;
    for (std::size_t i = 0; i < statistics.size(); ++i) {
      if (!computed[i]) return tl::unexpected<Error>(std::move(computed[i].error()));
      figures.emplace(statistics[i].text, std::move(*computed[i]));
    }
    std::map<int, std::vector<std::vector<double>>> values;
    for (const int metric : MetricsOfTrials(experiment)) {
      SEXTANT_ASSIGN_OR_RETURN(values[metric], TrialValuesOf(rows, metric));
    }
    data.values_.push_back(std::move(values));
    data.cells_.push_back(rows.cells());
    data.figures_.push_back(std::move(figures));
  }
  return data;
}

std::string PlaceWithout(const Experiment& experiment, const Condition& condition,
                         const std::string& axis) {
  std::string place = condition.base;
  for (std::size_t i = 0; i < experiment.axes.size(); ++i) {
    if (experiment.axes[i] == axis) continue;
    place +=
        fmt::format("{}{} = {}", place.empty() ? "" : ", ", experiment.axes[i], condition.place[i]);
  }
  return place;
}

std::string SubjectText(const Condition& condition, const CellKey& cell) {
  const std::string& subject = condition.trials->subjects()[static_cast<std::size_t>(cell.subject)];
  return cell.index == 0 ? subject : fmt::format("{} #{}", subject, cell.index);
}

}  // namespace sextant
