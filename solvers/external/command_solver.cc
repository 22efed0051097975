// SPDX-License-Identifier: Apache-2.0
#include "solvers/external/command_solver.h"

#include <fmt/core.h>

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "base/process/run_process.h"
#include "base/spec_text.h"
#include "base/text/printable.h"
#include "io/problems/problem_yaml.h"
#include "io/results/pose_answer.h"

namespace sextant {
namespace {

enum class CommandData { kPoints, kPixels };

struct CommandOptions {
  CommandData data = CommandData::kPoints;
  int min_pairs = 3;
  double timeout_s = 60.0;
};

OptionSet<CommandOptions> CommandOptionSet() {
  OptionSet<CommandOptions> options;
  options
      .Choice("data", &CommandOptions::data, {"points", "pixels"},
              "the pairs that the program gets: 3D-3D, or 2D-3D and the camera")
      .Count("min_pairs", &CommandOptions::min_pairs, 1, 1000, "fewer pairs are refused")
      .Real("timeout_s", &CommandOptions::timeout_s, "s", 0.001, 86400.0,
            "a program that runs longer is killed, and has no answer");
  return options;
}

// Words separated by blanks; single quotes hold blanks. Empty where a quote is not closed.
std::vector<std::string> WordsOf(std::string_view text) {
  std::vector<std::string> words;
  bool in_word = false;
  bool in_quotes = false;
  for (const char c : text) {
    if (c == '\'') {
      in_quotes = !in_quotes;
    } else if (c == ' ' && !in_quotes) {
      in_word = false;
      continue;
    }
    if (!in_word) words.emplace_back();
    in_word = true;
    if (c != '\'') words.back().push_back(c);
  }
  if (in_quotes) words.clear();
  return words;
}

std::string LastLine(std::string_view text) {
  constexpr std::size_t kMaxQuoted = 200;
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
  const std::size_t begin = text.rfind('\n');
  return Printable(begin == std::string_view::npos ? text : text.substr(begin + 1), kMaxQuoted);
}

DataNeeds NeedsOf(const CommandOptions& options) {
  DataNeeds needs;
  const bool of_points = options.data == CommandData::kPoints;
  (of_points ? needs.pairs_3d3d : needs.pairs_2d3d) = options.min_pairs;
  return needs;
}

/// The pairs of one kind, and what belongs to them.
CalibrationProblem ProblemFor(const CalibrationProblem& problem, CommandData data) {
  CalibrationProblem seen;
  seen.camera = problem.camera;
  seen.boards = problem.boards;
  seen.initial_cam_from_lidar = problem.initial_cam_from_lidar;
  if (data == CommandData::kPoints) {
    seen.pairs_3d3d = problem.pairs_3d3d;
    seen.point_sets = problem.point_sets;
  } else {
    seen.pairs_2d3d = problem.pairs_2d3d;
  }
  return seen;
}

class CommandSolver final : public Solver {
 public:
  CommandSolver(const std::string& name, std::vector<std::string> words,
                const CommandOptions& options)
      : Solver({.name = name, .needs = NeedsOf(options)}),
        words_(std::move(words)),
        options_(options) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    const CalibrationProblem seen = ProblemFor(problem, options_.data);
    const std::chrono::duration<double> timeout(options_.timeout_s);
    constexpr std::size_t kMaxAnswerBytes = std::size_t{64} << 20;
    SEXTANT_ASSIGN_OR_RETURN(
        const ProcessEnd end,
        RunProcess(words_,
                   {.standard_input = FormatProblemYaml({seen, {}, {}}),
                    .timeout = std::chrono::duration_cast<std::chrono::milliseconds>(timeout),
                    .max_bytes = kMaxAnswerBytes}));
    if (end.exit_code != 0) {
      return MakeError(ErrorCode::kIo, fmt::format("{}: exit code {}: {}", words_.front(),
                                                   end.exit_code, LastLine(end.err)));
    }
    const std::size_t pairs = seen.pairs_3d3d.size() + seen.pairs_2d3d.size();
    Expected<Estimate> estimate = ParsePoseAnswer(end.out, static_cast<int>(pairs));
    if (!estimate) {
      return MakeError(estimate.error().code,
                       fmt::format("{}: {}", words_.front(), estimate.error().message));
    }
    return estimate;
  }

  std::vector<std::string> words_;
  CommandOptions options_;
};

std::vector<OptionDoc> CommandOptionDocs() {
  std::vector<OptionDoc> docs = {
      {kSpecText, "", "text", "the program and its arguments, in double quotes"}};
  for (OptionDoc& doc : CommandOptionSet().Describe()) docs.push_back(std::move(doc));
  return docs;
}

Expected<SolverPtr> MakeCommand(const SolverArguments& arguments, Commands commands) {
  std::string text;
  for (const auto& [key, value] : arguments.options) {
    if (key == kSpecText) text = value;
  }
  std::vector<std::string> words = WordsOf(text);
  if (words.empty()) {
    return MakeError(ErrorCode::kInvalidOption,
                     "solver 'command': expected the program and its arguments in double quotes, "
                     "as command(\"python3 my_solver.py\"), every single quote closed");
  }
  if (commands == Commands::kRefused) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("solver 'command' would run the program {}; a file may do so only "
                                 "with --allow-commands",
                                 Quoted(words.front())));
  }
  SEXTANT_ASSIGN_OR_RETURN(const CommandOptions options,
                           CommandOptionSet().Parse(arguments.options));
  return std::make_shared<CommandSolver>(arguments.name, std::move(words), options);
}

}  // namespace

SolverEntry CommandEntry(Commands commands) {
  return {
      .name = "command",
      .summary = "another program: the problem on its standard input, the pose on its output",
      .needs = "3D-3D pairs, or 2D-3D pairs with data=pixels",
      .reference = "docs/formats.md, Solvers of other programs",
      .example = "command(\"python3 my_solver.py\")",
      .options = CommandOptionDocs(),
      .make =
          [commands](const SolverArguments& arguments) { return MakeCommand(arguments, commands); },
  };
}

}  // namespace sextant
