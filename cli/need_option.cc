// SPDX-License-Identifier: Apache-2.0
#include "cli/need_option.h"

namespace sextant::cli {

void DeclareNeed(std::vector<double>& need, Arguments& arguments) {
  arguments.Add(
      "--need", need,
      "The accuracy that you need, for the verdict: MM,DEG, 1 sigma of the least certain\n"
      "direction",
      {.shows_default = true,
       .range = {{1e-3, 1e6}},
       .min_values = 2,
       .max_values = 2,
       .separator = ','});
}

}  // namespace sextant::cli
