// SPDX-License-Identifier: Apache-2.0
// Experiments: a file with its solvers replaced, run on all cores, to columns and pages.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <filesystem>

#include "eval/experiment/report/report.h"
#include "eval/experiment/report/write_report.h"
#include "eval/experiment/run/run_trials.h"
#include "io/output/output_folder.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/catalogue.h"
#include "python/raise.h"

namespace sextant::python {
namespace {

struct RunRequest {
  std::string path;
  std::vector<std::string> solvers;
  std::uint64_t trials = 0;
  std::optional<std::uint64_t> seed;
  bool quick = false;
  int threads = 0;
  std::string folder;    ///< With rows.sxtrows.
  bool is_kept = false;  ///< Lock the folder and write the report into it.
  bool resumes = false;  ///< Keep the rows of an earlier run there.
};

struct FinishedRun {
  std::string plain;
  std::string markdown;
  std::string summary;
};

Experiment LoadExperimentOf(const RunRequest& request, const SolverRegistry& registry) {
  Experiment experiment = ValueOf(ReadExperiment(
      request.path, BuiltinKinds(), registry, fmt::format("{}", fmt::join(request.solvers, ","))));
  if (request.quick) experiment.trials = experiment.quick_trials;
  if (request.trials > 0) experiment.trials = request.trials;
  if (request.seed) experiment.seed = *request.seed;
  return experiment;
}

FinishedRun RunExperiment(const Experiment& experiment, const RunRequest& request) {
  const std::filesystem::path folder = request.folder;
  const std::filesystem::path rows = folder / "rows.sxtrows";
  std::optional<OutputFolder> lock;
  if (request.is_kept) {
    lock.emplace(ValueOf(OutputFolder::Open(folder)));
    ValueOf(ClaimReportFiles(experiment, folder, {}));
  }
  // An interrupt ends the run between two blocks; the rows that are written stay.
  ValueOf(RunTrials(experiment,
                    {.rows_path = rows,
                     .threads = request.threads,
                     .fresh = !request.resumes,
                     .after_block = [](std::uint64_t, std::uint64_t) { EndIfInterrupted(); }}));
  if (request.is_kept) ValueOf(WriteReport(experiment, rows, folder, {}));
  const RowFileReader reader = ValueOf(RowFileReader::Open(rows));
  const ReportData data = ValueOf(ReportData::Compute(experiment, reader));
  return {.plain = FormatPlain(experiment, data),
          .markdown = FormatMarkdown(experiment, data),
          .summary = ValueOf(FormatSummary(experiment, reader, data))};
}

// Every row: numbers of condition, subject, trial and step, and the metrics by name.
struct RowColumns {
  std::vector<int> condition;
  std::vector<int> subject;
  std::vector<int> trial;
  std::vector<int> index;
  std::vector<std::vector<double>> metrics;
};

RowColumns ReadColumns(const Experiment& experiment, const RowFileReader& reader) {
  RowColumns columns;
  columns.metrics.resize(reader.columns());
  const std::uint64_t per_condition = BlocksPerCondition(experiment);
  const auto block_trials = static_cast<std::uint64_t>(experiment.trials_per_block);
  for (const RowBlockPlace& block : reader.blocks()) {
    const std::uint64_t first = block.number % per_condition * block_trials;
    for (const std::uint64_t key : ValueOf(reader.ReadKeys(block))) {
      columns.condition.push_back(static_cast<int>(block.number / per_condition));
      columns.subject.push_back(SubjectOfKey(key));
      columns.trial.push_back(static_cast<int>(first + TrialOfKey(key)));
      columns.index.push_back(IndexOfKey(key));
    }
    for (std::size_t i = 0; i < columns.metrics.size(); ++i) {
      const std::vector<double> values = ValueOf(reader.ReadColumn(block, i));
      columns.metrics[i].insert(columns.metrics[i].end(), values.begin(), values.end());
    }
  }
  return columns;
}

py::dict DictOf(const Experiment& experiment, const RowColumns& columns) {
  py::dict metrics;
  std::size_t column = 0;
  for (std::size_t i = 0; i < experiment.metrics.size(); ++i) {
    if (!experiment.wanted[i]) continue;
    metrics[py::str(experiment.metrics[i].name)] =
        ArrayOf(std::span<const double>(columns.metrics[column++]));
  }
  py::list conditions;
  for (const Condition& condition : experiment.conditions) {
    conditions.append(
        py::make_tuple(condition.name, condition.place, condition.trials->subjects()));
  }
  py::dict result;
  result["name"] = experiment.name;
  result["axes"] = experiment.axes;
  result["conditions"] = conditions;
  result["condition"] = ArrayOf(std::span<const int>(columns.condition));
  result["subject"] = ArrayOf(std::span<const int>(columns.subject));
  result["trial"] = ArrayOf(std::span<const int>(columns.trial));
  result["index"] = ArrayOf(std::span<const int>(columns.index));
  result["metrics"] = metrics;
  return result;
}

py::dict Run(const std::string& path, const std::vector<std::string>& solvers, std::uint64_t trials,
             std::optional<std::uint64_t> seed, bool quick, int threads, const std::string& folder,
             bool is_kept, bool resumes) {
  const RunRequest request{path, solvers, trials, seed, quick, threads, folder, is_kept, resumes};
  const std::shared_ptr<const SolverRegistry> registry = Catalogue();
  const Experiment experiment = WithoutGil([&] { return LoadExperimentOf(request, *registry); });
  const FinishedRun run = WithoutGil([&] { return RunExperiment(experiment, request); });
  const RowColumns columns = WithoutGil([&] {
    return ReadColumns(experiment, ValueOf(RowFileReader::Open(request.folder + "/rows.sxtrows")));
  });
  py::dict result = DictOf(experiment, columns);
  result["plain"] = run.plain;
  result["markdown"] = run.markdown;
  result["summary"] = run.summary;
  return result;
}

}  // namespace

void BindExperiment(py::module_& module) {
  module.def("run_experiment", &Run, py::arg("path"), py::arg("solvers"), py::arg("trials"),
             py::arg("seed"), py::arg("quick"), py::arg("threads"), py::arg("folder"),
             py::arg("is_kept"), py::arg("resumes"));
}

}  // namespace sextant::python
