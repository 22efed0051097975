// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cli/given_options.h"

// How a command states its options, its help and its run, without the library that parses them.
namespace sextant::cli {

/// The variable that an argument sets. A bool makes a flag; a vector takes any number of values,
/// unless the rules limit them.
using ArgumentTarget =
    std::variant<bool*, int*, std::uint64_t*, double*, std::string*, std::optional<int>*,
                 std::optional<std::uint64_t>*, std::optional<double>*, std::vector<int>*,
                 std::vector<double>*, std::vector<std::string>*>;

struct ArgumentRange {
  double low = 0.0;
  double high = 0.0;
};

/// What an argument names for the command to write. The paths of a call are checked before it runs:
/// none is empty, an input or another output, and no file is replaced that sextant did not write,
/// unless --overwrite is given, which every command that writes has.
enum class Writes {
  kNothing,
  kFile,                  ///< A file; of several values the last.
  kFileOrStandardOutput,  ///< "-" is standard output.
  kCheckedByCommand,  ///< Files whose names the command forms, or that it continues (ClaimOutput).
  kFolder,
};

/// Whatever the rules, a number must be finite and the whole text, an unsigned one has no sign, and
/// a text is not empty.
struct ArgumentRules {
  bool required = false;
  bool shows_default = false;            ///< The help shows the variable's initial value.
  std::optional<ArgumentRange> range{};  ///< Allowed numbers, both ends included.
  int min_values = 0;                    ///< For a vector; 0: any number.
  int max_values = 0;                    ///< The same as min_values if 0.
  char separator = '\0';                 ///< Splits one value into several.
  std::vector<std::string> choices{};    ///< The only values allowed, in any case.
  std::vector<std::string> offers{};     ///< What shells complete where there are no choices.
  std::string excludes{};                ///< Name of an option that may not be given as well.
  std::string needs{};  ///< Name of an option without which this one would have no effect.
  Writes writes = Writes::kNothing;  ///< Only for strings.
};

/// An option ("--json") or a positional argument ("FILE").
struct Argument {
  std::string name;
  ArgumentTarget target;
  std::string help;
  ArgumentRules rules;
};

/// The arguments of one command, in the order of its help.
class Arguments {
 public:
  template <class Value>
  void Add(std::string name, Value& value, std::string help, ArgumentRules rules = {}) {
    all_.push_back({std::move(name), &value, std::move(help), std::move(rules)});
  }

  /// Where the parser notes which of the arguments the user gave, for a command that has to tell a
  /// default from a given value.
  void ReportGiven(GivenOptions& given) { given_ = &given; }

  const std::vector<Argument>& all() const { return all_; }
  GivenOptions* given() const { return given_; }  ///< Null: not asked for.

  /// Whether the command writes files, and so has the flag kOverwrite.
  bool HaveOutputs() const {
    return std::ranges::any_of(
        all_, [](const Argument& argument) { return argument.rules.writes != Writes::kNothing; });
  }

 private:
  std::vector<Argument> all_;
  GivenOptions* given_ = nullptr;
};

/// The flag of every command that writes files.
inline constexpr const char* kOverwrite = "--overwrite";
inline constexpr const char* kOverwriteHelp =
    "Replace also files that sextant did not write, or that were changed since";

struct Command {
  std::string name;
  std::string summary;  ///< One line for the list of commands.
  std::string footer;   ///< Notes and examples, below the options.
  std::function<void(Arguments&)> declare{};
  std::function<int()> run{};  ///< Returns the exit code. Empty if a subcommand is required.
  std::vector<Command> subcommands{};
};

/// A command whose options are members of `Options`: `declare` binds them, `run` reads them.
template <class Options>
Command MakeCommand(const std::string& name, const std::string& summary, const std::string& footer,
                    void (*declare)(Options&, Arguments&), int (*run)(const Options&)) {
  // The parser writes to the options after this function has returned.
  const auto options = std::make_shared<Options>();
  return {.name = name,
          .summary = summary,
          .footer = footer,
          .declare = [options, declare](Arguments& arguments) { declare(*options, arguments); },
          .run = [options, run] { return run(*options); }};
}

/// Commands under one title of the program's help.
struct CommandGroup {
  std::string title;
  std::vector<Command> commands;
};

struct Program {
  std::string name;
  std::string version{};  ///< What --version prints.
  std::string introduction;
  std::string footer;
  std::vector<CommandGroup> groups;
  /// Names that commands had in earlier versions, with their present names.
  std::vector<std::pair<std::string, std::string>> renamed{};
};

}  // namespace sextant::cli
