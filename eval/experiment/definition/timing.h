// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "eval/experiment/definition/experiment.h"

namespace sextant {

/// Time that a subject took for one trial of a condition, in microseconds.
struct TimingRow {
  std::string condition;
  std::string subject;
  double median_us = 0.0;
  double p25_us = 0.0;
  double p75_us = 0.0;
};

/// The metric of wall time. It is not part of the rows, which are the same in every run; only
/// TimeSubjects measures it.
inline constexpr const char* kTimeMetric = "time_us";

/// Runs `timed_trials` trials of every condition on the calling thread. Empty if the kind does not
/// measure time.
std::vector<TimingRow> TimeSubjects(const Experiment& experiment,
                                    const std::function<void()>& after_trial);

std::string FormatTimingMarkdown(const Experiment& experiment, const std::vector<TimingRow>& rows);
std::string FormatTimingJson(const std::vector<TimingRow>& rows);

}  // namespace sextant
