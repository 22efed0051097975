// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/definition/statistic.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/nearest_name.h"
#include "base/options.h"
#include "base/spec.h"
#include "eval/experiment/definition/timing.h"

namespace sextant {
namespace {

Expected<int> FindMetric(const std::string& name, const std::vector<Metric>& metrics) {
  if (name == kTimeMetric) {
    return MakeError(
        ErrorCode::kInvalidOption,
        "time differs from run to run and is not part of the rows; use timed_trials instead");
  }
  const auto found = std::find_if(metrics.begin(), metrics.end(),
                                  [&name](const Metric& metric) { return metric.name == name; });
  if (found != metrics.end()) return static_cast<int>(found - metrics.begin());
  std::vector<std::string> known;
  for (const Metric& metric : metrics) known.push_back(metric.name);
  return MakeError(ErrorCode::kUnknownName,
                   fmt::format("unknown metric '{}'; {}", name, SuggestName(name, known)));
}

Expected<void> SetKind(const std::string& name, Statistic& statistic) {
  using Kind = Statistic::Kind;
  const auto quantile = [&statistic](double q) {
    statistic.kind = Kind::kQuantile;
    statistic.quantile = q;
  };
  if (name == "mean") {
    statistic.kind = Kind::kMean;
  } else if (name == "rms") {
    statistic.kind = Kind::kRms;
  } else if (name == "sd") {
    statistic.kind = Kind::kSd;
  } else if (name == "rate") {
    statistic.kind = Kind::kRate;
  } else if (name == "efficiency") {
    statistic.kind = Kind::kEfficiency;
  } else if (name == "auc") {
    statistic.kind = Kind::kArea;
  } else if (name == "min") {
    quantile(0.0);
  } else if (name == "median") {
    quantile(0.5);
  } else if (name == "max") {
    quantile(1.0);
  } else if (name.size() == 3 && name[0] == 'p' && name != "p00" && name[1] >= '0' &&
             name[1] <= '9' && name[2] >= '0' && name[2] <= '9') {
    quantile(((name[1] - '0') * 10 + (name[2] - '0')) / 100.0);
  } else {
    const std::vector<std::string> known = {"mean", "rms",        "sd",  "min", "median", "max",
                                            "rate", "efficiency", "auc", "p05", "p95"};
    return MakeError(ErrorCode::kUnknownName,
                     fmt::format("unknown statistic '{}'; {}", name, SuggestName(name, known)));
  }
  return {};
}

Expected<void> SetOption(const std::string& key, const std::string& value,
                         const std::vector<Metric>& metrics, Statistic& statistic) {
  if (key == "where") {
    return FindMetric(value, metrics).map([&](int metric) { statistic.where = metric; });
  }
  if (key == "decimals") {
    return ParseCount(key, value, 0, 9).map([&](std::int64_t decimals) {
      statistic.decimals = static_cast<int>(decimals);
    });
  }
  if (key == "limit" && statistic.kind == Statistic::Kind::kArea) {
    return ParseReal(key, value, 1e-12, 1e12).map([&](double limit) { statistic.limit = limit; });
  }
  const std::vector<std::string> known = {"where", "decimals", "limit"};
  return MakeError(ErrorCode::kUnknownName,
                   fmt::format("unknown option '{}'; {}", key, SuggestName(key, known)));
}

Expected<void> Fill(const SpecNode& node, const std::vector<Metric>& metrics,
                    Statistic& statistic) {
  SEXTANT_RETURN_IF_ERROR(SetKind(node.name, statistic));
  const bool takes_two = statistic.kind == Statistic::Kind::kEfficiency;
  if (node.inner.size() != (takes_two ? 2U : 1U)) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("expected {} in its parentheses, got {}",
                                 takes_two ? "two metrics" : "one metric", node.inner.size()));
  }
  SEXTANT_ASSIGN_OR_RETURN(int metric, FindMetric(node.inner[0].name, metrics));
  statistic.metric = metric;
  if (takes_two) {
    SEXTANT_ASSIGN_OR_RETURN(int reference, FindMetric(node.inner[1].name, metrics));
    statistic.reference = reference;
  }
  for (const auto& [key, value] : node.options) {
    SEXTANT_RETURN_IF_ERROR(SetOption(key, value, metrics, statistic));
  }
  if (statistic.kind == Statistic::Kind::kArea && statistic.limit == 0.0) {
    return MakeError(ErrorCode::kParse, "expected limit=X, where the area ends");
  }
  return {};
}

}  // namespace

Expected<Statistic> ParseStatistic(const std::string& text, const std::vector<Metric>& metrics) {
  const auto refuse = [&text](Error error) {
    error.message = fmt::format("statistic '{}': {}", text.substr(0, 80), error.message);
    return tl::unexpected<Error>(std::move(error));
  };
  const Expected<SpecNode> node = ParseSpec(text);
  if (!node) return refuse(node.error());
  Statistic statistic{.text = FormatSpec(*node), .label = {}};
  if (Expected<void> ok = Fill(*node, metrics, statistic); !ok) return refuse(ok.error());
  statistic.label = statistic.text;
  return statistic;
}

}  // namespace sextant
