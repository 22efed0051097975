// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/real_data.h"

#include <cstdlib>
#include <system_error>

namespace sextant {

namespace fs = std::filesystem;

fs::path RealDataFolder(const fs::path& experiments) {
  const char* set = std::getenv("SEXTANT_DATA");  // NOLINT(concurrency-mt-unsafe): read only.
  return set != nullptr ? fs::path(set) : experiments / ".." / ".." / "shared" / "data";
}

Expected<fs::path> RealFile(const std::string& name, const fs::path& experiments) {
  const fs::path path = RealDataFolder(experiments) / name;
  std::error_code error;
  if (fs::exists(path, error)) return path;
  return MakeError(ErrorCode::kMissingData,
                   "the real data is absent: set SEXTANT_DATA to the folder that has " + name);
}

fs::path RealDataSet::Find(const std::string& name) const {
  std::error_code error;
  return fs::exists(beside / name, error) ? beside / name : data / name;
}

Expected<RealDataSet> OpenRealData(const std::string& manifest, const fs::path& experiments) {
  const fs::path path = experiments / manifest;
  RealDataSet set{
      .manifest = {}, .data = RealDataFolder(experiments), .beside = path.parent_path()};
  SEXTANT_ASSIGN_OR_RETURN(set.manifest, ReadManifest(path));
  const Expected<void> there = CheckFiles(set.manifest, set.data);
  if (!there && there.error().code == ErrorCode::kMissingData) {
    return MakeError(ErrorCode::kMissingData,
                     there.error().message + ": set SEXTANT_DATA to the folder that has it");
  }
  if (!there) return tl::unexpected<Error>(there.error());
  return set;
}

}  // namespace sextant
