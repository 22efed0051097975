// SPDX-License-Identifier: Apache-2.0
// In place of calibrate_bag.cc where the libraries of recordings were not found.
#include "cli/calibrate_source.h"

namespace sextant::cli {

Expected<RecordedViews> LookAtRecording(const Session& session, const ObserveRecording&) {
  return MakeError(ErrorCode::kMissingData,
                   "cannot read '" + session.bag.string() +
                       "': this build has no recordings of ROS. Install libbz2-dev, liblz4-dev, "
                       "libzstd-dev and libsqlite3-dev, configure with -DSEXTANT_BAG=ON and build "
                       "again");
}

}  // namespace sextant::cli
