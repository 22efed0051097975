// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant::cli {

/// The names of the options and arguments that the user gave; a default is not given.
using GivenOptions = std::vector<std::string>;

/// Whether the user gave one of them.
bool IsGiven(const GivenOptions& given, std::string_view name);

/// Refuses the first of `names` that the user gave where it would have no effect. Error:
/// kInvalidOption, "NAME <why>; leave it out".
Expected<void> RefuseGiven(const GivenOptions& given, std::initializer_list<const char*> names,
                           std::string_view why);

}  // namespace sextant::cli
