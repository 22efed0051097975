// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/options.h"

namespace sextant {

/// Parameters of a kind of experiment: those of an OptionSet, and texts (paths, names, lists of
/// numbers), which are checked where they are used.
template <class Options>
class ParameterSet {
 public:
  ParameterSet& Real(std::string name, double Options::*member, std::string unit, double low,
                     double high, std::string meaning) {
    options_.Real(std::move(name), member, std::move(unit), low, high, std::move(meaning));
    return *this;
  }

  // The member may belong to a base class of Options.
  template <class Integer, class Base>
  ParameterSet& Count(std::string name, Integer Base::*member, std::int64_t low, std::int64_t high,
                      std::string meaning) {
    options_.Count(std::move(name), static_cast<Integer Options::*>(member), low, high,
                   std::move(meaning));
    return *this;
  }

  template <class Enum, class Base>
  ParameterSet& Choice(std::string name, Enum Base::*member, std::vector<std::string> choices,
                       std::string meaning) {
    options_.Choice(std::move(name), static_cast<Enum Options::*>(member), std::move(choices),
                    std::move(meaning));
    return *this;
  }

  ParameterSet& Text(std::string name, std::string Options::*member, std::string unit,
                     std::string meaning) {
    texts_.push_back(
        {{std::move(name), Options{}.*member, std::move(unit), std::move(meaning)}, member});
    return *this;
  }

  /// If a name is given more than once, its last value counts. Error: kInvalidOption.
  Expected<Options> Parse(const OptionValues& values) const {
    Expected<Options> options = options_.Parse(values);
    if (!options) return options;
    for (const auto& [name, text] : values) {
      for (const TextOption& option : texts_) {
        if (option.doc.name == name) (*options).*(option.member) = text;
      }
    }
    return options;
  }

  std::vector<OptionDoc> Describe() const {
    std::vector<OptionDoc> docs;
    for (const TextOption& option : texts_) docs.push_back(option.doc);
    for (OptionDoc& doc : options_.Describe()) docs.push_back(std::move(doc));
    return docs;
  }

 private:
  struct TextOption {
    OptionDoc doc;
    std::string Options::*member;
  };

  OptionSet<Options> options_;
  std::vector<TextOption> texts_;
};

}  // namespace sextant
