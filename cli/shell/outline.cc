// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/outline.h"

#include <type_traits>

namespace sextant::cli {
namespace {

template <class Value>
struct Traits {
  static constexpr bool kRepeats = false;
  static constexpr bool kIsNumber = std::is_arithmetic_v<Value>;
};
template <class Value>
struct Traits<std::optional<Value>> : Traits<Value> {};
template <class Value>
struct Traits<std::vector<Value>> : Traits<Value> {
  static constexpr bool kRepeats = true;
};

// Texts complete as paths: most of them are.
std::string ValueName(const ArgumentRules& rules, bool is_number) {
  if (is_number) return "NUMBER";
  return rules.choices.empty() && rules.offers.empty() ? "FILE" : "TEXT";
}

OutlinedArgument OutlineOf(const Argument& argument) {
  OutlinedArgument outlined{.name = argument.name, .value = {}, .help = argument.help};
  outlined.choices =
      argument.rules.choices.empty() ? argument.rules.offers : argument.rules.choices;
  outlined.required = argument.rules.required;
  std::visit(
      [&](const auto* target) {
        using Value = std::remove_cvref_t<decltype(*target)>;
        if constexpr (!std::is_same_v<Value, bool>) {
          outlined.value = ValueName(argument.rules, Traits<Value>::kIsNumber);
          outlined.repeats = Traits<Value>::kRepeats && argument.rules.separator == '\0';
        }
      },
      argument.target);
  return outlined;
}

void AppendOutline(const Command& command, const std::string& before, const std::string& group,
                   std::vector<OutlinedCommand>& all) {
  OutlinedCommand outlined{.name = before + command.name,
                           .group = group,
                           .summary = command.summary,
                           .footer = command.footer};
  Arguments arguments;
  if (command.declare) command.declare(arguments);
  for (const Argument& argument : arguments.all()) {
    (argument.name.starts_with("-") ? outlined.options : outlined.positionals)
        .push_back(OutlineOf(argument));
  }
  if (arguments.HaveOutputs()) {
    outlined.options.push_back({.name = kOverwrite, .value = {}, .help = kOverwriteHelp});
  }
  outlined.options.push_back({.name = "--help", .value = {}, .help = "Show the help and exit"});
  for (const Command& sub : command.subcommands) outlined.subcommands.push_back(sub.name);
  all.push_back(std::move(outlined));
  for (const Command& sub : command.subcommands) {
    AppendOutline(sub, before + command.name + " ", group, all);
  }
}

}  // namespace

std::vector<OutlinedCommand> Outline(const Program& program) {
  std::vector<OutlinedCommand> all;
  for (const CommandGroup& group : program.groups) {
    for (const Command& command : group.commands) AppendOutline(command, "", group.title, all);
  }
  return all;
}

std::string FirstSentence(const std::string& text) {
  std::string line = text;
  for (char& c : line) c = c == '\n' ? ' ' : c;
  for (const char* end : {"; ", ". ", ": "}) line = line.substr(0, line.find(end));
  return line;
}

}  // namespace sextant::cli
