// SPDX-License-Identifier: Apache-2.0
// bench_scaling <folder of the programs> <folder of the page> [--quick]: growth of time and memory
// with points, outliers, views, trials, threads and ranks; writes scaling.md and its plots.
#include <fmt/core.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <thread>

#include "base/random.h"
#include "bench/machine.h"
#include "bench/scaling_chart.h"
#include "eval/synthetic/mismatched_pairs.h"
#include "eval/synthetic/random_scene.h"
#include "eval/synthetic/simulate_views.h"
#include "io/output/output_file.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"

namespace sextant::bench {
namespace {

namespace fs = std::filesystem;

struct Settings {
  fs::path programs;
  fs::path page;
  bool quick = false;
};

// Stop here, as the next point would take ten times as long.
constexpr double kMaxSeconds = 0.3;

// Far more than the noise with the fewest points, so that only wrong results are not timed.
constexpr double kMaxRadians = 0.1;
constexpr double kMaxMetres = 0.3;

// Returns whether the result is right.
bool MeasureSolve(const Solver& solver, const CalibrationProblem& problem, const Rigid3d& truth,
                  const Measure& measure) {
  std::optional<Rigid3d> answer;
  measure([&] {
    const Expected<SolveReport> report = solver.Solve(problem);
    if (report) answer = report->cam_from_lidar;
  });
  if (!answer) return false;
  const PoseDistance off = DistanceBetween(*answer, truth);
  return off.rotation_rad < kMaxRadians && off.translation_m < kMaxMetres;
}

void PrintCost(const std::string& curve, double x, const std::optional<Cost>& cost) {
  fmt::print(stderr, "{} at {:.7g}: {}\n", curve, x,
             cost ? fmt::format("{:.3g} s, {:.1f} MB", cost->seconds, cost->peak_mb)
                  : "wrong or failed, left out");
}

// A curve over numbers of pairs or fractions of outliers; x is the one that varies.
struct SceneAt {
  double x = 0.0;
  int pairs = 0;
  double outliers = 0.0;
};

Curve SolverCurve(const std::string& spec, const std::vector<SceneAt>& places) {
  const SolverPtr solver = *BuiltinSolvers().Make(spec);
  Curve curve{.name = spec, .points = {}};
  for (const SceneAt& at : places) {
    const std::optional<Cost> cost = CostOfCall([&](const Measure& measure) {
      const RandomSceneOptions options{.pairs = at.pairs, .sigma_m = 0.01, .sigma_px = 1.0};
      Random random(7);
      RandomScene scene = MakeRandomScene(options, random);
      MismatchPairs(options, InlierCount(at.pairs, at.outliers), random, scene);
      scene.problem.point_sets = {};
      const bool from_pixels = solver->spec().needs.pairs_2d3d > 0;
      if (from_pixels) scene.problem.pairs_3d3d.clear();
      if (!from_pixels) scene.problem.pairs_2d3d.clear();
      return MeasureSolve(*solver, scene.problem, scene.cam_from_lidar, measure);
    });
    PrintCost(spec, at.x, cost);
    if (cost) curve.points.push_back({at.x, *cost});
    if (cost && cost->seconds > kMaxSeconds) break;
  }
  return curve;
}

Chart PointsChart(const Settings& settings) {
  Chart chart{.name = "points",
              .title = "Points",
              .text =
                  "Complete solves including the covariance: pairs without outliers, 1 cm or 1 px "
                  "of noise; up to about one second each. Memory is what a solve adds to its "
                  "problem, the pages of its code and of the allocator included, about 1 MB.",
              .x = "pairs",
              .log_x = true,
              .rates = false,
              .amount = 1.0,
              .curves = {}};
  const int most = settings.quick ? 10'000 : 1'000'000;
  for (const char* spec : {"kabsch", "gnc(kabsch)", "ransac(kabsch)", "epnp", "sqpnp",
                           "refine(epnp)", "ransac(p3p)"}) {
    std::vector<SceneAt> places;
    for (int pairs = 10; pairs <= most; pairs *= 10) {
      places.push_back({static_cast<double>(pairs), pairs, 0.0});
    }
    chart.curves.push_back(SolverCurve(spec, places));
  }
  return chart;
}

Chart OutliersChart() {
  Chart chart{.name = "outliers",
              .title = "Outliers",
              .text =
                  "The given percentage of 100 pairs is joined to the point of another pair. "
                  "Percentages at which a solver does not find the pose are left out.",
              .x = "percent of outliers",
              .log_x = false,
              .rates = false,
              .amount = 1.0,
              .curves = {}};
  for (const char* spec : {"ransac(kabsch)", "gnc(kabsch)", "clique(kabsch)", "ransac(p3p)",
                           "gnc(epnp)", "refine(ransac(p3p))"}) {
    std::vector<SceneAt> places;
    for (int percent = 0; percent <= 90; percent += 10) {
      places.push_back({static_cast<double>(percent), 100, 0.01 * percent});
    }
    chart.curves.push_back(SolverCurve(spec, places));
  }
  return chart;
}

Chart ViewsChart(const Settings& settings) {
  Chart chart{.name = "views",
              .title = "Views",
              .text =
                  "Views of a board with raw observations. Each board's pose is eliminated "
                  "separately (Schur complement), so the cost of `joint` is linear.",
              .x = "views",
              .log_x = true,
              .rates = false,
              .amount = 1.0,
              .curves = {}};
  for (const char* spec : {"kabsch", "joint(kabsch)", "joint(gnc(kabsch),board_size=scale)"}) {
    const SolverPtr solver = *BuiltinSolvers().Make(spec);
    Curve curve{.name = spec, .points = {}};
    for (const int views : {1, 3, 10, 30, 100, 300, 1000}) {
      if (settings.quick && views > 100) break;
      const std::optional<Cost> cost = CostOfCall([&](const Measure& measure) {
        const Expected<SimulatedViews> session = SimulateViews({.seed = 3, .views = views});
        return session &&
               MeasureSolve(*solver, session->problem, session->true_cam_from_lidar, measure);
      });
      PrintCost(spec, views, cost);
      if (cost) curve.points.push_back({static_cast<double>(views), *cost});
    }
    chart.curves.push_back(std::move(curve));
  }
  return chart;
}

// An experiment with kabsch at eight pairs, including its report.
class Sweep {
 public:
  explicit Sweep(const Settings& settings)
      : settings_(settings),
        folder_(fs::temp_directory_path() / fmt::format("scaling_{}", getpid())) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "sweep.yaml")
        << "kind: random_scene\ntrials: 1000\nsolvers: [kabsch]\n"
           "parameters: {data: points, pairs: 8}\nmetrics: [rotation_deg, translation_mm]\n"
           "tables: [{columns: ['rms(rotation_deg, where=fine)', 'p95(translation_mm)', "
           "'efficiency(rotation_deg, bound_rotation_deg, where=fine)']}]\n";
  }
  ~Sweep() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Sweep(const Sweep&) = delete;
  Sweep& operator=(const Sweep&) = delete;

  std::optional<Cost> Run(std::vector<std::string> start, long trials, int threads) const {
    for (const std::string& argument :
         {std::string("run"), (folder_ / "sweep.yaml").string(), std::string("--fresh"),
          std::string("--no-csv"), std::string("--out"), (folder_ / "out").string(),
          std::string("--trials"), std::to_string(trials), std::string("--threads"),
          std::to_string(threads)}) {
      start.push_back(argument);
    }
    return CostOfProgram(start);
  }

  std::string Program(const char* name) const { return (settings_.programs / name).string(); }

 private:
  Settings settings_;
  fs::path folder_;
};

int Cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

Chart TrialsChart(const Settings& settings, const Sweep& sweep) {
  Chart chart{.name = "trials",
              .title = "Trials",
              .text =
                  "`sextant run` including its report, on all cores: kabsch at 8 pairs, two "
                  "metrics. Rows are kept on disk, so memory does not grow with them.",
              .x = "trials",
              .log_x = true,
              .rates = false,
              .amount = 1.0,
              .curves = {{.name = "sextant run", .points = {}}}};
  for (long trials = 1000; trials <= (settings.quick ? 100'000 : 10'000'000); trials *= 10) {
    const std::optional<Cost> cost = sweep.Run({sweep.Program("sextant")}, trials, Cores());
    PrintCost("sextant run", static_cast<double>(trials), cost);
    if (cost) chart.curves[0].points.push_back({static_cast<double>(trials), *cost});
  }
  return chart;
}

Chart CoresChart(const Settings& settings, const Sweep& sweep) {
  const long trials = settings.quick ? 50'000 : 400'000;
  Chart chart{.name = "cores",
              .title = "Threads and ranks",
              .text = fmt::format(
                  "{} trials of the same experiment, run separately for each point: threads of one "
                  "`sextant run`, ranks of `sextant-mpi` with one thread each. "
                  "This machine has {} cores; memory is that of the largest "
                  "process.",
                  trials, Cores()),
              .x = "threads or ranks",
              .log_x = false,
              .rates = true,
              .amount = static_cast<double>(trials),
              .curves = {}};
  Curve threads{.name = "threads", .points = {}};
  Curve ranks{.name = "ranks", .points = {}};
  for (int count = 1; count <= 2 * Cores(); count *= 2) {
    const std::optional<Cost> of_threads = sweep.Run({sweep.Program("sextant")}, trials, count);
    PrintCost(threads.name, count, of_threads);
    if (of_threads) threads.points.push_back({static_cast<double>(count), *of_threads});
#ifdef SEXTANT_MPIRUN
    const std::optional<Cost> of_ranks =
        sweep.Run({SEXTANT_MPIRUN, "-n", std::to_string(count), "--oversubscribe", "--bind-to",
                   "none", sweep.Program("sextant-mpi")},
                  trials, 1);
    PrintCost(ranks.name, count, of_ranks);
    if (of_ranks) ranks.points.push_back({static_cast<double>(count), *of_ranks});
#endif
  }
  chart.curves.push_back(std::move(threads));
  if (!ranks.points.empty()) chart.curves.push_back(std::move(ranks));
  return chart;
}

Expected<void> WritePage(const std::vector<Chart>& charts, const Settings& settings) {
  std::string page = fmt::format(
      "# Cost as work grows\n\nWritten by `scripts/scaling`; do not edit. Time is the minimum of "
      "several calls, or that of a complete program run; memory is the peak. Every result was "
      "checked against the truth before timing.\n\n- machine: {}\n\n",
      DescribeMachine());
  std::error_code error;
  fs::create_directories(settings.page / "scaling", error);
  for (const Chart& chart : charts) {
    SEXTANT_RETURN_IF_ERROR(DrawChart(chart, settings.page / "scaling"));
    page += ChapterOf(chart) + (&chart == &charts.back() ? "" : "\n");
  }
  return WriteFileAtomically(settings.page / "scaling.md", page);
}

int Main(const Settings& settings) {
  const Sweep sweep(settings);
  const std::vector<Chart> charts = {PointsChart(settings), OutliersChart(), ViewsChart(settings),
                                     TrialsChart(settings, sweep), CoresChart(settings, sweep)};
  if (Expected<void> ok = WritePage(charts, settings); !ok) {
    fmt::print(stderr, "bench_scaling: {}\n", ok.error().message);
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace sextant::bench

int main(int argc, char** argv) {
  const bool quick = argc == 4 && std::strcmp(argv[3], "--quick") == 0;
  if (argc != 3 && !quick) {
    std::fputs("usage: bench_scaling <folder of the programs> <folder of the page> [--quick]\n",
               stderr);
    return 2;
  }
  return sextant::bench::Main({.programs = argv[1], .page = argv[2], .quick = quick});
}
