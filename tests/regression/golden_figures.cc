// SPDX-License-Identifier: Apache-2.0
#include "regression/golden_figures.h"

#include <fmt/core.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

namespace sextant {
namespace {

using FigurePlace = std::tuple<std::string, std::string, std::string>;

std::map<FigurePlace, GoldenFigure> ByPlace(const std::vector<GoldenFigure>& figures) {
  std::map<FigurePlace, GoldenFigure> by_place;
  for (const GoldenFigure& f : figures) by_place[{f.condition, f.subject, f.statistic}] = f;
  return by_place;
}

std::string Name(const GoldenFigure& figure) {
  return fmt::format("{}, {}: {}", figure.subject, figure.condition, figure.statistic);
}

bool IsRate(const GoldenFigure& figure) { return figure.statistic.starts_with("rate("); }

bool IsWorse(const GoldenFigure& golden, const GoldenFigure& now) {
  return IsRate(golden) ? now.value < golden.low : now.value > golden.high;
}

}  // namespace

std::vector<GoldenFigure> CollectFigures(const Experiment& experiment, const ReportData& data) {
  std::vector<GoldenFigure> figures;
  for (std::size_t c = 0; c < experiment.conditions.size(); ++c) {
    const Condition& condition = experiment.conditions[c];
    for (std::size_t cell = 0; cell < data.cells(c).size(); ++cell) {
      for (const TableSpec& table : experiment.tables) {
        for (const Statistic& column : table.columns) {
          const Figure& figure = data.figures(c, column)[cell];
          if (!std::isfinite(figure.value) || !figure.interval) continue;
          figures.push_back({condition.name, SubjectText(condition, data.cells(c)[cell]),
                             column.text, figure.value, figure.interval->low,
                             figure.interval->high});
        }
      }
    }
  }
  return figures;
}

std::string FormatGolden(const std::vector<GoldenFigure>& figures) {
  std::string text = "[\n";
  for (const GoldenFigure& figure : figures) {
    const nlohmann::json names = {figure.condition, figure.subject, figure.statistic};
    text += fmt::format("{}, {:.6g}, {:.6g}, {:.6g}]{}\n",
                        names.dump().substr(0, names.dump().size() - 1), figure.value, figure.low,
                        figure.high, &figure == &figures.back() ? "" : ",");
  }
  return text + "]\n";
}

Expected<std::vector<GoldenFigure>> ParseGolden(const std::string& text, const std::string& file) {
  const auto json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  const auto refuse = [&file] {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: expected a list of [condition, solver, statistic, value, "
                                 "low, high]; write it with scripts/update-golden",
                                 file));
  };
  if (!json.is_array()) return refuse();
  std::vector<GoldenFigure> figures;
  for (const auto& line : json) {
    if (!line.is_array() || line.size() != 6) return refuse();
    for (std::size_t i = 0; i < 6; ++i) {
      if (i < 3 ? !line[i].is_string() : !line[i].is_number()) return refuse();
    }
    figures.push_back({line[0].get<std::string>(), line[1].get<std::string>(),
                       line[2].get<std::string>(), line[3].get<double>(), line[4].get<double>(),
                       line[5].get<double>()});
  }
  return figures;
}

std::vector<std::string> CompareWithGolden(const std::vector<GoldenFigure>& golden,
                                           const std::vector<GoldenFigure>& now) {
  const std::map<FigurePlace, GoldenFigure> before = ByPlace(golden);
  const std::map<FigurePlace, GoldenFigure> after = ByPlace(now);
  std::vector<std::string> lines;
  for (const GoldenFigure& figure : now) {
    const auto found = before.find({figure.condition, figure.subject, figure.statistic});
    if (found == before.end()) {
      lines.push_back(Name(figure) + " is new; run scripts/update-golden");
      continue;
    }
    const GoldenFigure& was = found->second;
    if (!IsWorse(was, figure)) continue;
    lines.push_back(fmt::format("{} is {:.4g}, was {:.4g} [{:.4g}, {:.4g}]: {:.1f} percent worse",
                                Name(figure), figure.value, was.value, was.low, was.high,
                                100.0 * std::abs(figure.value / was.value - 1.0)));
  }
  for (const GoldenFigure& figure : golden) {
    if (after.count({figure.condition, figure.subject, figure.statistic}) == 0) {
      lines.push_back(Name(figure) + " is missing: the solver no longer returns a pose there");
    }
  }
  return lines;
}

}  // namespace sextant
