// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "base/units.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/problem_input.h"
#include "eval/metrics/compare.h"
#include "eval/metrics/default_specs.h"
#include "report/overlay.h"
#include "report/report_text.h"
#include "solvers/all/all_solvers.h"

namespace sextant::cli {
namespace {

struct SolveOptions {
  ProblemInputOptions input{};
  std::string solver{};                ///< Empty: chosen by the data.
  std::vector<std::string> overlay{};  ///< Image to draw on and file to write; empty: none.
};

void Declare(SolveOptions& options, Arguments& arguments) {
  DeclareProblemInput(options.input, arguments);
  arguments.Add(
      "--solver", options.solver,
      "A solver, possibly composed; see sextant list solvers. Default: kabsch for 3D-3D\n"
      "pairs, or robust(kabsch) where there are outliers; for 2D-3D pairs refine(sqpnp), or\n"
      "refine(ransac(p3p)) where it finds no pose or outliers, or p3p for three pairs");
  arguments.Add("--overlay", options.overlay,
                "IMAGE OUT: draw measured and reprojected points on the image, residuals x10",
                {.min_values = 2, .writes = Writes::kFile});
}

std::string TextOf(const CalibrationProblem& problem, const Solver& solver,
                   const ComparisonRow& row) {
  std::string text = DescribeReport(problem, solver.spec(), *row.report);
  if (row.from_truth) {
    text +=
        fmt::format("  error against the truth    {:.2f} mm, {:.4f} deg\n",
                    row.from_truth->translation_m * 1e3, row.from_truth->rotation_rad * kDegPerRad);
  }
  return text;
}

int Run(const SolveOptions& options) {
  const SolverRegistry registry = AllSolvers(Commands::kAllowed);
  Expected<SolverPtr> solver = registry.Make(options.solver.empty() ? "kabsch" : options.solver);
  if (!solver) return Refuse("solve", solver.error());
  const Expected<LoadedProblem> input = LoadProblem(options.input);
  if (!input) return Refuse("solve", input.error());
  const CalibrationProblem& problem = input->file.problem;
  if (options.solver.empty()) {
    solver = registry.Make(DefaultSpec(registry, problem));
    if (!solver) return Refuse("solve", solver.error());
  }
  const std::vector<ComparisonRow> rows =
      Compare(problem, {&*solver, 1}, input->file.true_cam_from_lidar);
  const ComparisonRow& row = rows.front();
  if (!row.report) {
    PrintNoAnswer("solve", options.input, *input, row);
    return DeliverAnswers("solve", options.input, *input, rows, "", false);
  }
  const int code =
      DeliverAnswers("solve", options.input, *input, rows, TextOf(problem, **solver, row), true);
  if (options.overlay.empty()) return code;
  const Expected<void> drawn = DrawOverlay(problem, *row.report, (*solver)->spec().needs,
                                           options.overlay[0], options.overlay[1]);
  return drawn ? code : Refuse("solve", drawn.error());
}

}  // namespace

Command SolveCommand() {
  constexpr const char* kFooter =
      "Examples:\n"
      "  sextant solve points.txt\n"
      "  sextant solve points.txt --solver 'refine(ransac(kabsch, seed=7), loss=huber)'\n"
      "  sextant solve pairs.csv --camera camera.yaml --solver 'refine(epnp)' --json result.json";
  return MakeCommand<SolveOptions>("solve", "The answer of one solver, with its uncertainty",
                                   kFooter, Declare, Run);
}

}  // namespace sextant::cli
