// SPDX-License-Identifier: Apache-2.0
#include "report/collect/frame_source.h"

#include <tbb/parallel_for.h>

#include <system_error>

#include "calibrate/observe/photo_file.h"
#include "io/clouds/cloud_file.h"

namespace sextant {
namespace {

Expected<Frame> ReadFiles(const ResultView& view, const std::filesystem::path& folder) {
  if (view.image_path.empty() || view.cloud_path.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     "The result names no files of this view; the report of sextant calibrate "
                     "--report has its photo and scan");
  }
  Frame frame{.name = view.name};
  SEXTANT_ASSIGN_OR_RETURN(frame.image, ReadImage(FoundFrom(folder, view.image_path)));
  SEXTANT_ASSIGN_OR_RETURN(frame.cloud, ReadCloud(FoundFrom(folder, view.cloud_path)));
  return frame;
}

}  // namespace

std::filesystem::path FoundFrom(const std::filesystem::path& folder, const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return path;
  const std::filesystem::path beside = folder / path;
  return std::filesystem::exists(beside, ignored) ? beside : std::filesystem::path(path);
}

FrameSource FramesOfFiles(const std::filesystem::path& folder) {
  return [folder](const std::vector<ResultView>& views, const FrameVisitor& visit) {
    tbb::parallel_for(std::size_t{0}, views.size(),
                      [&](std::size_t i) { visit(i, ReadFiles(views[i], folder)); });
    return Expected<void>();
  };
}

}  // namespace sextant
