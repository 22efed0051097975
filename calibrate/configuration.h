// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calibrate/observe_session.h"
#include "calibrate/options.h"

namespace sextant {

/// Every setting that shapes the result besides the measurements, as "name: value" lines; their
/// hash identifies runs of the same configuration. `solver` is the canonical name of the solver
/// that gives the result.
std::vector<std::string> ConfigurationLines(const ObservedSession& observed,
                                            const CalibrateOptions& options,
                                            const std::string& solver);

/// The initial cam_from_lidar: that of the options or, where it has none, of the session.
MatchSettings MatchSettingsFor(const Session& session, const CalibrateOptions& options);

}  // namespace sextant
