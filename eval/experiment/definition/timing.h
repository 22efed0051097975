// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "eval/experiment/definition/experiment.h"

namespace sextant {

/// How long a subject took for one trial of a condition, in microseconds.
struct TimingRow {
  std::string condition;
  std::string subject;
  double median_us = 0.0;
  double p25_us = 0.0;
  double p75_us = 0.0;
};

/// The metric of wall time. It is no part of the rows, which are the same in every run: the runner
/// asks for it here alone.
inline constexpr const char* kTimeMetric = "time_us";

/// Runs `timed_trials` of every condition on this thread alone. Empty where the kind does not
/// measure its time.
std::vector<TimingRow> TimeSubjects(const Experiment& experiment,
                                    const std::function<void()>& after_trial);

std::string FormatTimingMarkdown(const Experiment& experiment, const std::vector<TimingRow>& rows);
std::string FormatTimingJson(const std::vector<TimingRow>& rows);

}  // namespace sextant
