// SPDX-License-Identifier: Apache-2.0
// Replaces the sources for recordings if their libraries were not found.
#include <fmt/core.h>

#include "cli/recordings.h"

namespace sextant::cli {
namespace {

constexpr const char* kAbsent =
    "this build cannot read or write recordings of ROS. Install libbz2-dev, liblz4-dev, "
    "libzstd-dev and libsqlite3-dev, configure with -DSEXTANT_BAG=ON and build again";

tl::unexpected<Error> CannotWrite() {
  return MakeError(ErrorCode::kMissingData, fmt::format("--bag: {}; or leave --bag out", kAbsent));
}

}  // namespace

Expected<OpenedRecording> OpenRecording(const std::string& path, double /*tolerance_s*/) {
  return MakeError(ErrorCode::kMissingData, fmt::format("cannot read '{}': {}", path, kAbsent));
}

Expected<void> CheckSessionBag(const SessionOptions&) { return CannotWrite(); }

Expected<void> WriteSessionBag(const std::filesystem::path&, const Scene&,
                               const std::vector<ScanTruth>&) {
  return CannotWrite();
}

}  // namespace sextant::cli
