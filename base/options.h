// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"

namespace sextant {

/// The documentation of one option in the catalogue.
struct OptionDoc {
  std::string name;
  std::string default_value;
  std::string unit;     ///< "m", "px", "1" and so on, or the choices "a|b".
  std::string meaning;  ///< One line.
};

using OptionValues = std::vector<std::pair<std::string, std::string>>;

Expected<double> ParseReal(const std::string& name, const std::string& text, double low,
                           double high);
Expected<std::int64_t> ParseCount(const std::string& name, const std::string& text,
                                  std::int64_t low, std::int64_t high);
Expected<std::size_t> ParseChoice(const std::string& name, const std::string& text,
                                  const std::vector<std::string>& choices);
/// A set of choices joined by +, as bits in their order; "none" is the empty set.
Expected<unsigned> ParseSet(const std::string& name, const std::string& text,
                            const std::vector<std::string>& choices);
std::string FormatReal(double value);

/// Binds option names to the members of a plain settings struct. The struct's member initialisers
/// are the only place for defaults; the catalogue reads them from there.
template <class Options>
class OptionSet {
 public:
  OptionSet& Real(std::string name, double Options::*member, std::string unit, double low,
                  double high, std::string meaning) {
    return Add(
        {name, FormatReal(Options{}.*member), std::move(unit), std::move(meaning)},
        [name, member, low, high](Options& options, const std::string& text) {
          return ParseReal(name, text, low, high).map([&](double v) { options.*member = v; });
        });
  }

  template <class Integer>
  OptionSet& Count(std::string name, Integer Options::*member, std::int64_t low, std::int64_t high,
                   std::string meaning) {
    return Add({name, std::to_string(Options{}.*member), "1", std::move(meaning)},
               [name, member, low, high](Options& options, const std::string& text) {
                 return ParseCount(name, text, low, high).map([&](std::int64_t v) {
                   options.*member = static_cast<Integer>(v);
                 });
               });
  }

  /// Enum values must be 0, 1, ... in the order of `choices`; bool is {"false", "true"}.
  template <class Enum>
  OptionSet& Choice(std::string name, Enum Options::*member, std::vector<std::string> choices,
                    std::string meaning) {
    std::string joined;
    for (const std::string& choice : choices) joined += (joined.empty() ? "" : "|") + choice;
    std::string default_value = choices[static_cast<std::size_t>(Options{}.*member)];
    return Add({name, std::move(default_value), std::move(joined), std::move(meaning)},
               [name, member, choices](Options& options, const std::string& text) {
                 return ParseChoice(name, text, choices).map([&](std::size_t i) {
                   options.*member = static_cast<Enum>(i);
                 });
               });
  }

  /// Any of the choices, joined by +; bit i of the member means choices[i]. None by default.
  OptionSet& Set(std::string name, unsigned Options::*member,
                 const std::vector<std::string>& choices, std::string meaning) {
    std::string joined;
    for (const std::string& choice : choices) joined += (joined.empty() ? "" : "+") + choice;
    return Add(
        {name, "none", "none|" + joined, std::move(meaning)},
        [name, member, choices](Options& options, const std::string& text) {
          return ParseSet(name, text, choices).map([&](unsigned bits) { options.*member = bits; });
        });
  }

  /// Requires known names; the registry checks them.
  Expected<Options> Parse(const OptionValues& values) const {
    Options options;
    for (const auto& [name, text] : values) {
      for (const Bound& bound : bound_) {
        if (bound.doc.name != name) continue;
        SEXTANT_RETURN_IF_ERROR(bound.set(options, text));
      }
    }
    return options;
  }

  std::vector<OptionDoc> Describe() const {
    std::vector<OptionDoc> docs;
    for (const Bound& bound : bound_) docs.push_back(bound.doc);
    return docs;
  }

 private:
  struct Bound {
    OptionDoc doc;
    std::function<Expected<void>(Options&, const std::string&)> set;
  };

  OptionSet& Add(OptionDoc doc, std::function<Expected<void>(Options&, const std::string&)> set) {
    bound_.push_back({std::move(doc), std::move(set)});
    return *this;
  }

  std::vector<Bound> bound_;
};

}  // namespace sextant
