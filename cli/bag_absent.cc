// SPDX-License-Identifier: Apache-2.0
// In place of bag_command.cc where the libraries of recordings were not found.
#include "cli/commands.h"
#include "cli/load.h"

namespace sextant::cli {

int RunBag(const BagOptions& options) {
  return Refuse("bag", {ErrorCode::kMissingData,
                        "cannot read '" + options.path +
                            "': this build has no recordings of ROS. Install libbz2-dev, "
                            "liblz4-dev, libzstd-dev and libsqlite3-dev, configure with "
                            "-DSEXTANT_BAG=ON and build again"});
}

}  // namespace sextant::cli
