// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cmath>
#include <iterator>

#include "base/text/escape.h"
#include "eval/experiment/report/report.h"
#include "eval/experiment/run/run_trials.h"
#include "io/output/output_file.h"

namespace sextant {
namespace {

std::string Header(const Experiment& experiment) {
  std::string line = "experiment,condition";
  for (const std::string& axis : experiment.axes) line += "," + CsvField(axis);
  line += ",subject,trial,index";
  for (std::size_t m = 0; m < experiment.metrics.size(); ++m) {
    if (experiment.wanted[m]) line += "," + CsvField(experiment.metrics[m].name);
  }
  return line + "\n";
}

// The fields that all rows of a subject begin with.
std::vector<std::string> Beginnings(const Experiment& experiment, const Condition& condition) {
  std::string common = CsvField(experiment.name) + "," + CsvField(condition.name);
  for (const std::string& place : condition.place) common += "," + CsvField(place);
  std::vector<std::string> beginnings;
  for (const std::string& subject : condition.trials->subjects()) {
    beginnings.push_back(common + "," + CsvField(subject));
  }
  return beginnings;
}

void AppendNumber(double value, std::string& text) {
  text += ',';
  if (!std::isnan(value)) fmt::format_to(std::back_inserter(text), "{}", value);
}

Expected<std::string> RowsText(const RowFileReader& reader, const RowBlockPlace& block,
                               std::uint64_t first_trial,
                               const std::vector<std::string>& beginnings) {
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<std::uint64_t> keys, reader.ReadKeys(block));
  std::vector<std::vector<double>> columns;
  for (std::size_t column = 0; column < reader.columns(); ++column) {
    SEXTANT_ASSIGN_OR_RETURN(std::vector<double> values, reader.ReadColumn(block, column));
    columns.push_back(std::move(values));
  }
  std::string text;
  for (std::size_t row = 0; row < keys.size(); ++row) {
    const std::uint64_t key = keys[row];
    text += beginnings[static_cast<std::size_t>(SubjectOfKey(key))];
    fmt::format_to(std::back_inserter(text), ",{},{}", first_trial + TrialOfKey(key),
                   IndexOfKey(key));
    for (const std::vector<double>& column : columns) AppendNumber(column[row], text);
    text += '\n';
  }
  return text;
}

}  // namespace

Expected<void> WriteRowsCsv(const Experiment& experiment, const RowFileReader& reader,
                            const std::filesystem::path& path) {
  SEXTANT_ASSIGN_OR_RETURN(OutputFile writer, OutputFile::Open(path));
  SEXTANT_RETURN_IF_ERROR(writer.Append(Header(experiment)));
  const std::uint64_t per_condition = BlocksPerCondition(experiment);
  const auto block_trials = static_cast<std::uint64_t>(experiment.trials_per_block);
  for (const RowBlockPlace& block : reader.blocks()) {
    const Condition& condition = experiment.conditions[block.number / per_condition];
    SEXTANT_ASSIGN_OR_RETURN(const std::string text,
                             RowsText(reader, block, block.number % per_condition * block_trials,
                                      Beginnings(experiment, condition)));
    SEXTANT_RETURN_IF_ERROR(writer.Append(text));
  }
  return writer.Commit();
}

}  // namespace sextant
