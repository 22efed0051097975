// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tags/opencv_aruco.h"

#include <algorithm>

namespace sextant {
namespace {

#if CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR < 7

const cv::aruco::Dictionary& ValueOf(const cv::Ptr<cv::aruco::Dictionary>& dictionary) {
  return *dictionary;
}

void KeepWindow(cv::aruco::DetectorParameters& /*parameters*/) {}

void Detect(const cv::Mat& image, const cv::aruco::Dictionary& dictionary,
            const cv::aruco::DetectorParameters& parameters,
            std::vector<std::vector<cv::Point2f>>& corners, std::vector<int>& ids) {
  cv::aruco::detectMarkers(image, cv::makePtr<cv::aruco::Dictionary>(dictionary), corners, ids,
                           cv::makePtr<cv::aruco::DetectorParameters>(parameters));
}

void Draw(const cv::aruco::Dictionary& dictionary, int id, int side_px, int border_cells,
          cv::Mat& image) {
  cv::aruco::drawMarker(cv::makePtr<cv::aruco::Dictionary>(dictionary), id, side_px, image,
                        border_cells);
}

#else

const cv::aruco::Dictionary& ValueOf(const cv::aruco::Dictionary& dictionary) { return dictionary; }

void KeepWindow(cv::aruco::DetectorParameters& parameters) {
  // Half the window is the lesser of cornerRefinementWinSize and this many cells.
  parameters.relativeCornerRefinmentWinSize = 1e6F;
}

void Detect(const cv::Mat& image, const cv::aruco::Dictionary& dictionary,
            const cv::aruco::DetectorParameters& parameters,
            std::vector<std::vector<cv::Point2f>>& corners, std::vector<int>& ids) {
  cv::aruco::ArucoDetector(dictionary, parameters).detectMarkers(image, corners, ids);
}

void Draw(const cv::aruco::Dictionary& dictionary, int id, int side_px, int border_cells,
          cv::Mat& image) {
  dictionary.generateImageMarker(id, side_px, image, border_cells);
}

#endif

}  // namespace

cv::aruco::Dictionary PredefinedArucoDictionary(int type) {
  return ValueOf(cv::aruco::getPredefinedDictionary(type));
}

cv::aruco::DetectorParameters ArucoParameters() {
  cv::aruco::DetectorParameters parameters;
  KeepWindow(parameters);
  return parameters;
}

std::vector<OpenCvTag> DetectAruco(const cv::Mat& image, const cv::aruco::Dictionary& dictionary,
                                   const cv::aruco::DetectorParameters& parameters) {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  Detect(image, dictionary, parameters, corners, ids);
  std::vector<OpenCvTag> tags(ids.size());
  for (std::size_t i = 0; i < tags.size(); ++i) {
    tags[i].id = ids[i];
    std::copy_n(corners[i].begin(), 4, tags[i].corners_px.begin());
  }
  return tags;
}

cv::Mat DrawArucoCells(const cv::aruco::Dictionary& dictionary, int id, int border_cells) {
  cv::Mat image;
  Draw(dictionary, id, dictionary.markerSize + 2 * border_cells, border_cells, image);
  return image;
}

}  // namespace sextant
