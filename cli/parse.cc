// SPDX-License-Identifier: Apache-2.0
// The only source that includes CLI11, which takes about 12 s to compile.
#include "cli/parse.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <span>
#include <sstream>
#include <string_view>
#include <type_traits>
#include <utility>

#include "base/nearest_name.h"
#include "base/text/printable.h"
#include "cli/output.h"
#include "io/text/number_text.h"

namespace sextant::cli {
namespace {

template <class Value>
struct NumberOf {
  using Type = Value;
};
template <class Value>
struct NumberOf<std::optional<Value>> {
  using Type = Value;
};

template <class Value>
struct NumberOf<std::vector<Value>> {
  using Type = Value;
};

// The fault of a value that is to be a number of this type within the range; empty if it has none.
// CLI11 takes NaN for a number in every range, and -1 for a large unsigned one.
template <class Number>
std::string FaultOf(const std::string& text, const std::optional<ArgumentRange>& range) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] =
      std::from_chars(text.data() + (text.starts_with('+') ? 1 : 0), end, value);
  const double number = static_cast<double>(value);
  const bool fits = error == std::errc() && stop == end && std::isfinite(number) &&
                    (!range || (number >= range->low && number <= range->high));
  if (fits) return {};
  std::string expected = std::is_integral_v<Number> ? "a whole number" : "a finite number";
  if (range) {
    expected += fmt::format(" from {} to {}", range->low, range->high);
  } else if (std::is_integral_v<Number>) {
    expected += fmt::format(" from {} to {}", std::numeric_limits<Number>::min(),
                            std::numeric_limits<Number>::max());
  }
  return fmt::format("expected {}, got {}", expected, Quoted(text));
}

template <class Number>
std::string DescribeRange(const std::optional<ArgumentRange>& range) {
  if (!range) return {};
  return fmt::format("{} in [{} - {}]", CLI::detail::type_name<Number>(), range->low, range->high);
}

// Every value of every command is checked here, before CLI11 converts it.
template <class Value>
void CheckValues(const ArgumentRules& rules, CLI::Option& option) {
  using One = typename NumberOf<Value>::Type;
  if constexpr (std::is_arithmetic_v<One>) {
    const auto fault = [range = rules.range](std::string& text) {
      return FaultOf<One>(text, range);
    };
    option.check(CLI::Validator(fault, DescribeRange<One>(rules.range)));
  } else {
    const std::string fault_if_empty = rules.writes == Writes::kNothing
                                           ? "expected a text, got an empty one"
                                           : "expected a path, got an empty text";
    const auto fault = [fault_if_empty](std::string& text) {
      return text.empty() ? fault_if_empty : std::string();
    };
    option.check(CLI::Validator(fault, ""));
  }
}

template <class Value>
CLI::Option& AddOption(const Argument& argument, Value& value, CLI::App& app) {
  CLI::Option& option = *app.add_option(argument.name, value, argument.help);
  CheckValues<Value>(argument.rules, option);
  return option;
}

CLI::Option& AddOption(const Argument& argument, bool& value, CLI::App& app) {
  return *app.add_flag(argument.name, value, argument.help);
}

void SetRules(const ArgumentRules& rules, CLI::App& app, CLI::Option& option) {
  if (rules.required) option.required();
  if (rules.shows_default) option.capture_default_str();
  if (rules.min_values > 0) {
    option.expected(rules.min_values, std::max(rules.min_values, rules.max_values));
  }
  if (rules.separator != '\0') option.delimiter(rules.separator);
  // transform() because check() would keep the case that the user wrote.
  if (!rules.choices.empty()) option.transform(CLI::IsMember(rules.choices, CLI::ignore_case));
  if (!rules.excludes.empty()) option.excludes(app.get_option(rules.excludes));
}

void AddCommand(const Command& command, const std::string& group, bool& overwrites,
                CLI::App& parent) {
  CLI::App& app = *parent.add_subcommand(command.name, command.summary);
  app.group(group);
  app.footer(command.footer);
  Arguments arguments;
  if (command.declare) command.declare(arguments);
  for (const Argument& argument : arguments.all()) {
    std::visit(
        [&](auto* value) { SetRules(argument.rules, app, AddOption(argument, *value, app)); },
        argument.target);
  }
  if (arguments.HaveOutputs()) app.add_flag(kOverwrite, overwrites, kOverwriteHelp);
  for (const Command& sub : command.subcommands) AddCommand(sub, "Subcommands", overwrites, app);
  if (!command.run) app.require_subcommand(1);
}

std::vector<const Command*> AllCommands(const Program& program) {
  std::vector<const Command*> all;
  for (const CommandGroup& group : program.groups) {
    for (const Command& command : group.commands) all.push_back(&command);
  }
  return all;
}

// The error for an argument that should name a command and does not; empty if it names one.
std::string UnknownName(const std::string& program, const std::string& name,
                        const std::vector<const Command*>& commands) {
  std::vector<std::string> known;
  for (const Command* command : commands) {
    if (command->name == name) return {};
    known.push_back(command->name);
  }
  return fmt::format("{} has no command {}; {}\n", program, Quoted(name), SuggestName(name, known));
}

// CLI11 would only report that a command is required.
std::string UnknownCommand(const Program& program, int argc, const char* const* argv) {
  if (argc < 2 || argv[1][0] == '-') return {};
  const std::string name = argv[1];
  for (const auto& [old_name, new_name] : program.renamed) {
    if (name == old_name) {
      return fmt::format("'{0} {1}' is now '{0} {2}'\n", program.name, name, new_name);
    }
  }
  const std::vector<const Command*> commands = AllCommands(program);
  std::string error = UnknownName(program.name, name, commands);
  if (!error.empty() || argc < 3 || argv[2][0] == '-') return error;
  for (const Command* command : commands) {
    if (command->name != name || command->run) continue;
    std::vector<const Command*> subcommands;
    for (const Command& sub : command->subcommands) subcommands.push_back(&sub);
    return UnknownName(program.name + " " + name, argv[2], subcommands);
  }
  return {};
}

// The command, or the subcommand, that the parsed line names.
struct Chosen {
  const Command* command = nullptr;
  std::string name;
};

Chosen FindChosen(const CLI::App& app, const std::vector<const Command*>& commands) {
  for (const Command* command : commands) {
    for (const CLI::App* sub : app.get_subcommands(nullptr)) {
      if (!sub->parsed() || sub->get_name() != command->name) continue;
      std::vector<const Command*> subcommands;
      for (const Command& one : command->subcommands) subcommands.push_back(&one);
      Chosen chosen = FindChosen(*sub, subcommands);
      if (chosen.command == nullptr) return {command, command->name};
      chosen.name = command->name + " " + chosen.name;
      return chosen;
    }
  }
  return {};
}

// The path that an argument gives; of several values the last.
std::string PathOf(const ArgumentTarget& target) {
  if (std::string* const* path = std::get_if<std::string*>(&target)) return **path;
  const auto* const paths = std::get_if<std::vector<std::string>*>(&target);
  return paths == nullptr || (*paths)->empty() ? std::string() : (*paths)->back();
}

// Appends the output that the argument names, if any; returns what is wrong with it.
std::string AddOutput(const Argument& argument, std::vector<OutputArgument>& outputs) {
  const Writes writes = argument.rules.writes;
  if (writes == Writes::kNothing) return {};
  OutputArgument output{.option = argument.name, .path = PathOf(argument.target), .writes = writes};
  if (output.path == "-" && writes != Writes::kFileOrStandardOutput) {
    return fmt::format("{}: expected a path, got '-'; it does not write to standard output\n",
                       argument.name);
  }
  if (!output.path.empty()) outputs.push_back(std::move(output));
  return {};
}

GivenOptions GivenOf(const Arguments& arguments, const CLI::App& app) {
  GivenOptions given;
  for (const Argument& argument : arguments.all()) {
    if (app.get_option(argument.name)->count() > 0) given.push_back(argument.name);
  }
  return given;
}

// The error for an option that has no effect without another one; empty if there is none.
std::string NeededOption(const Arguments& arguments, const GivenOptions& given) {
  for (const Argument& argument : arguments.all()) {
    const std::string& needed = argument.rules.needs;
    if (needed.empty() || !IsGiven(given, argument.name) || IsGiven(given, needed)) continue;
    return fmt::format("{0} has no effect without {1}: add {1}, or leave {0} out\n", argument.name,
                       needed);
  }
  return {};
}

ParsedLine LineOf(const Chosen& chosen, const CLI::App& app, bool overwrites) {
  ParsedLine line{.run = chosen.command->run, .command = chosen.name, .overwrites = overwrites};
  // Declaring again gives the variables, which now hold the values of the line.
  Arguments arguments;
  if (chosen.command->declare) chosen.command->declare(arguments);
  const GivenOptions given = GivenOf(arguments, app);
  if (arguments.given() != nullptr) *arguments.given() = given;
  if (const std::string error = NeededOption(arguments, given); !error.empty()) {
    return {.exit_code = kWrongUse, .err = fmt::format("sextant {}: {}", chosen.name, error)};
  }
  for (const Argument& argument : arguments.all()) {
    const std::string error = AddOutput(argument, line.outputs);
    if (!error.empty()) return {.exit_code = kWrongUse, .err = error};
  }
  return line;
}

// The innermost command that the line names, with the names of those around it.
std::pair<const CLI::App*, std::string> ChosenApp(const CLI::App& app) {
  const CLI::App* chosen = &app;
  std::string name = app.get_name();
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (const CLI::App* sub : chosen->get_subcommands(nullptr)) {
      if (!sub->parsed()) continue;
      chosen = sub;
      name += " " + sub->get_name();
      goes_on = true;
      break;
    }
  }
  return {chosen, name};
}

// The error for an argument before a subcommand, which has its own; empty if there is none.
std::string BeforeSubcommand(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    if (!command->parsed()) continue;
    for (const CLI::App* sub : command->get_subcommands(nullptr)) {
      if (!sub->parsed()) continue;
      for (const CLI::Option* option : command->get_options()) {
        if (option->count() == 0) continue;
        return fmt::format("{0} does not go before {1}; see '{2} {3} {1} --help'\n",
                           option->get_name(), sub->get_name(), app.get_name(),
                           command->get_name());
      }
    }
  }
  return {};
}

std::vector<std::string> OptionsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

// The error for a number that CLI11 took for options of one letter each; empty if there is none.
std::string NotFinite(int argc, const char* const* argv) {
  std::string option;
  for (const std::string_view text : std::span(argv, static_cast<std::size_t>(argc))) {
    if (text.starts_with("--")) option = text;
    const std::string lower = CLI::detail::to_lower(std::string(text));
    if (lower == "-nan" || lower == "-inf") {
      return fmt::format("{}: expected a finite number, got {}\n", option, Quoted(text));
    }
  }
  return {};
}

// The error for an argument that the command does not take; empty if there is none. CLI11 would
// report a required argument that is missing as well before it.
std::string UnknownArgument(const CLI::App& app) {
  const std::vector<std::string> unknown = app.remaining(/*recurse=*/true);
  if (unknown.empty()) return {};
  const auto [chosen, command] = ChosenApp(app);
  const auto is_option = [](const std::string& text) {
    return text.size() > 1 && text[0] == '-' && text.find_first_of("0123456789.") != 1;
  };
  const auto option = std::find_if(unknown.begin(), unknown.end(), is_option);
  if (option == unknown.end()) {
    return fmt::format("{0}: unexpected argument {1}; see '{0} --help'\n", command,
                       Quoted(unknown.front()));
  }
  const std::string name = option->substr(0, option->find('='));
  const std::string nearest = NearestName(name, OptionsOf(*chosen));
  return fmt::format("{0} has no option {1}; {2}see '{0} --help'\n", command, Quoted(name),
                     nearest.empty() ? "" : fmt::format("did you mean {}? Or ", nearest));
}

}  // namespace

ParsedLine ParseLine(const Program& program, int argc, const char* const* argv) {
  if (std::string error = UnknownCommand(program, argc, argv); !error.empty()) {
    return {.exit_code = kWrongUse, .err = std::move(error)};
  }
  CLI::App app(program.introduction, program.name);
  app.set_version_flag("--version", program.version);
  app.set_help_all_flag("--help-all", "The help of every command");
  app.require_subcommand(1);
  app.footer(program.footer);
  bool overwrites = false;
  for (const CommandGroup& group : program.groups) {
    for (const Command& command : group.commands) AddCommand(command, group.title, overwrites, app);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out;
    std::ostringstream err;
    const int code = app.exit(error, out, err);
    std::string unknown = code == 0 ? "" : NotFinite(argc, argv);
    if (code != 0 && unknown.empty()) unknown = UnknownArgument(app);
    if (!unknown.empty()) return {.exit_code = kWrongUse, .err = std::move(unknown)};
    return {.exit_code = code == 0 ? kAnswered : kWrongUse, .out = out.str(), .err = err.str()};
  }
  if (std::string error = BeforeSubcommand(app); !error.empty()) {
    return {.exit_code = kWrongUse, .err = std::move(error)};
  }
  return LineOf(FindChosen(app, AllCommands(program)), *ChosenApp(app).first, overwrites);
}

}  // namespace sextant::cli
