// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/definition/timing.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/text/escape.h"
#include "eval/statistics/statistics.h"
#include "eval/statistics/text_table.h"

namespace sextant {

std::vector<TimingRow> TimeSubjects(const Experiment& experiment,
                                    const std::function<void()>& after_trial) {
  const auto metric =
      static_cast<std::size_t>(std::find_if(experiment.metrics.begin(), experiment.metrics.end(),
                                            [](const Metric& m) { return m.name == kTimeMetric; }) -
                               experiment.metrics.begin());
  std::vector<TimingRow> timings;
  if (metric == experiment.metrics.size()) return timings;
  std::bitset<kMaxMetrics> wanted;
  wanted.set(metric);
  for (const Condition& condition : experiment.conditions) {
    TrialRows rows(experiment.metrics.size(), wanted);
    for (std::uint64_t trial = 0; trial < experiment.timed_trials; ++trial) {
      condition.trials->Run({.trial = trial, .seed = SeedOf(experiment, condition, trial)}, rows);
      after_trial();
    }
    std::map<std::uint16_t, std::vector<double>> times;
    for (std::size_t row = 0; row < rows.keys().size(); ++row) {
      const double time = rows.values()[row * rows.metrics() + metric];
      if (std::isfinite(time)) times[rows.keys()[row].subject].push_back(time);
    }
    for (auto& [subject, values] : times) {
      std::sort(values.begin(), values.end());
      timings.push_back({.condition = condition.name,
                         .subject = condition.trials->subjects()[subject],
                         .median_us = QuantileOfSorted(values, 0.5),
                         .p25_us = QuantileOfSorted(values, 0.25),
                         .p75_us = QuantileOfSorted(values, 0.75)});
    }
  }
  return timings;
}

std::string FormatTimingMarkdown(const Experiment& experiment, const std::vector<TimingRow>& rows) {
  std::string text = fmt::format(
      "# Time of {}\n\nMedian and quartiles in microseconds over {} trials on one thread; only "
      "trials with an answer count.\n",
      MarkdownText(experiment.title), experiment.timed_trials);
  for (const Condition& condition : experiment.conditions) {
    TextTable table({"", "time [us]", "from", "to"});
    for (const TimingRow& row : rows) {
      if (row.condition != condition.name) continue;
      table.AddRow(
          {row.subject, Fixed(row.median_us, 1), Fixed(row.p25_us, 1), Fixed(row.p75_us, 1)});
    }
    text += fmt::format("\n## {}\n\n{}", MarkdownText(condition.name), table.Markdown());
  }
  return text;
}

std::string FormatTimingJson(const std::vector<TimingRow>& rows) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const TimingRow& row : rows) {
    json.push_back({{"condition", row.condition},
                    {"subject", row.subject},
                    {"median_us", row.median_us},
                    {"p25_us", row.p25_us},
                    {"p75_us", row.p75_us}});
  }
  return JsonText(json, 1);
}

}  // namespace sextant
