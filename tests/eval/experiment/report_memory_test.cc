// SPDX-License-Identifier: Apache-2.0
// The memory of a report does not grow with the number of trials. Synthetic rows replace a long
// run.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <string>

#include "base/random.h"
#include "eval/experiment/report/report.h"
#include "eval/experiment/run/run_trials.h"
#include "solvers/builtin_solvers.h"
#include "support/run_program.h"

namespace sextant::test {
namespace {

Experiment LongExperiment(int trials) {
  return *ParseExperiment(
      "kind: random_scene\ntrials: " + std::to_string(trials) +
          "\nsolvers: [kabsch]\nparameters: {data: points}\nmetrics: [rotation_deg]\n"
          "tables: [{columns: ['rms(rotation_deg, where=fine)', 'p95(rotation_deg)', "
          "'efficiency(rotation_deg, bound_rotation_deg, where=fine)', 'sd(rotation_deg)']}]\n",
      "long.yaml", BuiltinKinds(), BuiltinSolvers());
}

void WriteMadeUpRows(const Experiment& experiment, const std::filesystem::path& path) {
  Expected<RowFileWriter> writer = RowFileWriter::Open(path, ConfigurationOf(experiment), true);
  ASSERT_TRUE(writer) << writer.error().message;
  Random random(3);
  const auto size = static_cast<std::uint64_t>(experiment.trials_per_block);
  for (std::uint64_t block = 0; block < BlocksOf(experiment); ++block) {
    TrialRows rows(experiment.metrics.size(), experiment.wanted);
    for (std::uint64_t trial = block * size; trial < (block + 1) * size; ++trial) {
      rows.BeginTrial(trial);
      MetricValues values = rows.Add(0);
      for (std::size_t m = 0; m < experiment.metrics.size(); ++m) {
        values.Set(static_cast<int>(m), 1.0 + random.Uniform());
      }
    }
    ASSERT_TRUE(writer->Append(MakeRowBlock(block, block * size, rows).Encode()));
  }
}

// Peak memory of this process in kilobytes after a report of this many trials.
long PeakAfterReport(int trials) {
  const Experiment experiment = LongExperiment(trials);
  const std::filesystem::path path = TestFolder() / "rows.sxtrows";
  WriteMadeUpRows(experiment, path);
  const RowFileReader reader = *RowFileReader::Open(path);
  EXPECT_EQ(reader.blocks().size(), BlocksOf(experiment));
  const Expected<ReportData> data = ReportData::Compute(experiment, reader);
  EXPECT_TRUE(data);
  EXPECT_EQ(data->figures(0, experiment.tables[0].columns[0])[0].trials,
            static_cast<std::uint64_t>(trials));
  EXPECT_TRUE(FormatSummary(experiment, reader, *data));
  EXPECT_TRUE(WriteRowsCsv(experiment, reader, TestFolder() / "rows.csv"));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

TEST(ReportMemory, DoesNotGrowWithTheTrials) {
#ifdef SEXTANT_SANITIZED
  GTEST_SKIP() << "sanitizers keep freed memory";
#endif
  const long few = PeakAfterReport(150'000);
  const long many = PeakAfterReport(900'000);
  // The positions of the blocks, 0.3 bytes per trial, plus allocator overhead; a single column
  // would take 6000.
  EXPECT_LT(many - few, 3000) << "kilobytes";
}

}  // namespace
}  // namespace sextant::test
