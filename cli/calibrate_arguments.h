// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "calibrate/options.h"
#include "cli/command.h"
#include "cli/search_options.h"

namespace sextant::cli {

/// The options of commands that calibrate: how boards are found, solved and judged.
struct CalibrateArguments {
  std::string solvers{};  ///< The first gives the result, the others are compared with it.
  std::vector<std::string> initial{};  ///< A file, or X Y Z QW QX QY QZ; empty: along the axes.
  std::string pose_is{};
  std::string detector{};
  std::string extractor = "rectangle";
  SearchArguments search{};
  std::vector<double> need = {10.0, 0.1};  ///< mm and degrees.
  int bootstrap = 100;                     ///< Samples; 0: neither bootstrap nor cross-validation.
};

void DeclareCalibrate(CalibrateArguments& how, Arguments& arguments);

/// Errors: those of the solvers' specs, PoseFromArgument and SearchOptionsFrom.
Expected<CalibrateOptions> CalibrateOptionsFrom(const CalibrateArguments& how);

}  // namespace sextant::cli
