// SPDX-License-Identifier: Apache-2.0
// In place of session_bag.cc where the libraries of recordings were not found.
#include "cli/session_bag.h"

namespace sextant::cli {
namespace {

tl::unexpected<Error> Absent() {
  return MakeError(ErrorCode::kMissingData,
                   "--bag: this build has no recordings of ROS. Install libbz2-dev, liblz4-dev, "
                   "libzstd-dev and libsqlite3-dev, configure with -DSEXTANT_BAG=ON and build "
                   "again; or leave --bag out");
}

}  // namespace

Expected<void> CheckSessionBag(const SessionOptions&) { return Absent(); }

Expected<void> WriteSessionBag(const std::filesystem::path&, const Scene&,
                               const std::vector<ScanTruth>&) {
  return Absent();
}

}  // namespace sextant::cli
