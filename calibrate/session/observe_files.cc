// SPDX-License-Identifier: Apache-2.0
#include "calibrate/session/observe_files.h"

#include <tbb/parallel_for.h>

#include "calibrate/observe/photo_file.h"
#include "io/clouds/cloud_file.h"

namespace sextant {
namespace {

Expected<Observation> ObservePair(const Observer& observer, const FilePair& pair) {
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat image, ReadImage(pair.image));
  SEXTANT_ASSIGN_OR_RETURN(const PointCloud cloud, ReadCloud(pair.cloud));
  return observer.Observe(image, cloud);
}

}  // namespace

std::vector<SessionView> ObserveFiles(const Observer& observer, std::span<const FilePair> pairs,
                                      const std::function<void()>& step) {
  std::vector<SessionView> views(pairs.size());
  tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
    views[i].name = pairs[i].name;
    views[i].image_path = pairs[i].image.string();
    views[i].cloud_path = pairs[i].cloud.string();
    views[i].seen = ObservePair(observer, pairs[i]);
    if (step) step();
  });
  return views;
}

}  // namespace sextant
