// SPDX-License-Identifier: Apache-2.0
#include "bench/compare.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "eval/statistics/text_table.h"

namespace sextant::bench {
namespace {

constexpr double kMinNoise = 0.03;

const char* NameOf(Change change) {
  switch (change) {
    case Change::kSlower:
      return "SLOWER";
    case Change::kNowWrong:
      return "WRONG";
    case Change::kGone:
      return "gone";
    case Change::kFaster:
      return "faster";
    case Change::kNew:
      return "new";
    case Change::kSame:
      return "same";
  }
  return "";
}

Difference CompareOne(const std::string& name, const Timing& before, const Timing& after) {
  Difference difference{.name = name};
  difference.old_ns = before.median_ns.value_or(0.0);
  difference.new_ns = after.median_ns.value_or(0.0);
  difference.noise = std::max(kMinNoise, 3.0 * std::hypot(before.spread, after.spread));
  if (before.median_ns && after.median_ns) {
    const double ratio = *after.median_ns / *before.median_ns;
    if (ratio > 1.0 + difference.noise) difference.change = Change::kSlower;
    if (1.0 / ratio > 1.0 + difference.noise) difference.change = Change::kFaster;
  } else if (before.median_ns) {
    difference.change = after.error.empty() ? Change::kGone : Change::kNowWrong;
  } else if (after.median_ns) {
    difference.change = Change::kNew;
  }
  return difference;
}

double Ratio(const Difference& difference) { return difference.new_ns / difference.old_ns; }

}  // namespace

std::vector<Difference> CompareTimings(const Timings& old_timings, const Timings& new_timings) {
  Timings both = old_timings;
  both.insert(new_timings.begin(), new_timings.end());
  const auto find = [](const Timings& timings, const std::string& name) {
    const auto found = timings.find(name);
    return found != timings.end() ? found->second : Timing{};
  };
  std::vector<Difference> differences;
  for (const auto& [name, ignored] : both) {
    differences.push_back(CompareOne(name, find(old_timings, name), find(new_timings, name)));
  }
  std::stable_sort(differences.begin(), differences.end(),
                   [](const Difference& a, const Difference& b) {
                     if (a.change != b.change) return a.change < b.change;
                     return a.change == Change::kSlower && Ratio(a) > Ratio(b);
                   });
  return differences;
}

bool HasRegression(const std::vector<Difference>& differences) {
  return std::any_of(differences.begin(), differences.end(), [](const Difference& difference) {
    return difference.change == Change::kSlower || difference.change == Change::kNowWrong;
  });
}

std::string FormatDifferences(const std::vector<Difference>& differences) {
  TextTable table({"benchmark", "", "old", "new", "new / old", "noise"});
  std::size_t same = 0;
  for (const Difference& difference : differences) {
    if (difference.change == Change::kSame) {
      ++same;
      continue;
    }
    const auto time = [](double ns) { return ns > 0.0 ? FormatTime(ns) : std::string("-"); };
    const bool both = difference.old_ns > 0.0 && difference.new_ns > 0.0;
    table.AddRow({difference.name, NameOf(difference.change), time(difference.old_ns),
                  time(difference.new_ns), both ? Fixed(Ratio(difference), 3) : "-",
                  both ? Fixed(100.0 * difference.noise, 1) + " %" : "-"});
  }
  const std::string changed = same == differences.size() ? "" : table.Plain() + "\n";
  return changed + fmt::format("{} of {} within the noise\n", same, differences.size());
}

}  // namespace sextant::bench
