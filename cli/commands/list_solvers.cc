// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "base/nearest_name.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "eval/statistics/text_table.h"
#include "io/output/standard_output.h"
#include "solvers/all/all_solvers.h"

namespace sextant::cli {
namespace {

struct ListSolversOptions {
  std::string name{};  ///< Empty: all, one line each.
  bool markdown = false;
};

void Declare(ListSolversOptions& options, Arguments& arguments) {
  arguments.Add("NAME", options.name, "One solver in full");
  arguments.Add("--markdown", options.markdown, "The whole catalogue as a page",
                {.excludes = "NAME"});
}

std::string Usage(const SolverEntry& entry) {
  return entry.wraps_solver ? entry.name + "(solver)" : entry.name;
}

TextTable OptionsTable(const SolverEntry& entry) {
  TextTable table({"option", "default", "unit or choices", "meaning"}, TextTable::Columns::kWords);
  for (const OptionDoc& option : entry.options) {
    table.AddRow({option.name, option.default_value, option.unit, option.meaning});
  }
  return table;
}

std::string InFull(const SolverEntry& entry) {
  std::string text =
      fmt::format("{}\n  does       {}\n  needs      {}\n  reference  {}\n  example    {}\n",
                  Usage(entry), entry.summary, entry.needs, entry.reference, entry.example);
  if (!entry.options.empty()) text += "\n" + OptionsTable(entry).Plain();
  return text;
}

std::string Page(const SolverRegistry& registry) {
  std::string text =
      "# Solvers\n\nWritten by `sextant list solvers --markdown`. Solvers compose: "
      "`refine(ransac(epnp, seed=7), loss=huber)`.\n";
  for (const SolverEntry& entry : registry.entries()) {
    text += fmt::format("\n## `{}`\n\n{}.\n\n- needs: {}\n- reference: {}\n- example: `{}`\n",
                        Usage(entry), entry.summary, entry.needs, entry.reference, entry.example);
    if (!entry.options.empty()) text += "\n" + OptionsTable(entry).Markdown();
  }
  return text;
}

std::string List(const SolverRegistry& registry) {
  std::size_t width = 0;
  for (const SolverEntry& entry : registry.entries()) width = std::max(width, Usage(entry).size());
  std::string text;
  for (const SolverEntry& entry : registry.entries()) {
    text += fmt::format("{:<{}}  {}\n{:<{}}  needs {}\n", Usage(entry), width, entry.summary, "",
                        width, entry.needs);
  }
  return text + "\nOptions, units, defaults and reference of one: sextant list solvers NAME\n";
}

int Run(const ListSolversOptions& options) {
  const SolverRegistry registry = AllSolvers();
  if (options.markdown) {
    Print("{}", Page(registry));
    return kAnswered;
  }
  if (options.name.empty()) {
    Print("{}", List(registry));
    return kAnswered;
  }
  std::vector<std::string> known;
  for (const SolverEntry& entry : registry.entries()) {
    if (entry.name == options.name) {
      Print("{}", InFull(entry));
      return kAnswered;
    }
    known.push_back(entry.name);
  }
  return Refuse("list solvers",
                {ErrorCode::kUnknownName, fmt::format("no solver '{}'; {}", options.name,
                                                      SuggestName(options.name, known))});
}

}  // namespace

Command ListSolversCommand() {
  return MakeCommand<ListSolversOptions>(
      "solvers", "The solvers, with their needs and options",
      "Examples:\n  sextant list solvers\n  sextant list solvers ransac", Declare, Run);
}

}  // namespace sextant::cli
