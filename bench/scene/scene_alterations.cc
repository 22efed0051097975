// SPDX-License-Identifier: Apache-2.0
#include "bench/scene/scene_alterations.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "base/random.h"
#include "base/units.h"
#include "features/scene/scan_sweeps.h"
#include "io/images/image_codec.h"

namespace sextant {
namespace {

using Alter = std::function<void(RawRecording&)>;

Alter OfPhotos(const std::function<void(cv::Mat&)>& change) {
  return [change](RawRecording& recording) {
    for (RawPair& pair : recording.pairs) change(pair.grey);
  };
}

// Grey level g becomes f(g / 255) * 255.
Alter OfGreyLevels(const std::function<double(double)>& f) {
  cv::Mat table(1, 256, CV_8U);
  for (int i = 0; i < 256; ++i) table.at<uchar>(i) = cv::saturate_cast<uchar>(255.0 * f(i / 255.0));
  return OfPhotos([table](cv::Mat& grey) {
    cv::Mat changed;
    cv::LUT(grey, table, changed);
    grey = changed;
  });
}

Alter WithNoise(double gain, double sigma_grey) {
  return OfPhotos([gain, sigma_grey](cv::Mat& grey) {
    Random random(11);
    cv::Mat changed(grey.size(), CV_8U);
    for (int y = 0; y < grey.rows; ++y) {
      for (int x = 0; x < grey.cols; ++x) {
        const double noise = sigma_grey * random.Normal();
        changed.at<uchar>(y, x) = cv::saturate_cast<uchar>(gain * grey.at<uchar>(y, x) + noise);
      }
    }
    grey = changed;
  });
}

Alter Blurred(double sigma_px) {
  return OfPhotos([sigma_px](cv::Mat& grey) {
    cv::Mat changed;
    cv::GaussianBlur(grey, changed, {0, 0}, sigma_px);
    grey = changed;
  });
}

Alter Compressed(int quality) {
  return OfPhotos([quality](cv::Mat& grey) {
    const auto bytes = EncodeImage(".jpg", grey, quality);
    if (bytes) grey = *DecodeImage(*bytes, DecodedColor::kGrey);
  });
}

void HalveSize(RawRecording& recording) {
  for (RawPair& pair : recording.pairs) {
    cv::Mat half;
    cv::resize(pair.grey, half, {pair.grey.cols / 2, pair.grey.rows / 2}, 0.0, 0.0, cv::INTER_AREA);
    pair.grey = half;
  }
  Camera& camera = recording.camera;
  camera.fx_px *= 0.5;
  camera.fy_px *= 0.5;
  camera.cx_px = 0.5 * (camera.cx_px + 0.5) - 0.5;
  camera.cy_px = 0.5 * (camera.cy_px + 0.5) - 0.5;
}

void CropMiddle(RawRecording& recording) {
  for (RawPair& pair : recording.pairs) {
    const cv::Rect part(pair.grey.cols / 5, pair.grey.rows / 6, 3 * pair.grey.cols / 5,
                        4 * pair.grey.rows / 6);
    recording.camera.cx_px -= &pair == recording.pairs.data() ? part.x : 0;
    recording.camera.cy_px -= &pair == recording.pairs.data() ? part.y : 0;
    pair.grey = pair.grey(part).clone();
  }
}

PointCloud Chosen(const PointCloud& scan, const std::vector<int>& indices) {
  PointCloud chosen;
  for (const int index : indices) {
    const auto i = static_cast<std::size_t>(index);
    chosen.points.push_back(scan.points[i]);
    if (!scan.ring.empty()) chosen.ring.push_back(scan.ring[i]);
  }
  return chosen;
}

// Every so many sweeps are kept.
Alter Thinned(std::size_t every, bool with_rings) {
  return [every, with_rings](RawRecording& recording) {
    for (RawPair& pair : recording.pairs) {
      const auto sweeps = FindSweeps(pair.scan);
      if (!sweeps) continue;
      PointCloud kept;
      for (std::size_t k = 0; k < sweeps->size(); k += every) {
        for (const int i : (*sweeps)[k]) {
          kept.points.push_back(pair.scan.points[static_cast<std::size_t>(i)]);
          if (with_rings) kept.ring.push_back(static_cast<std::uint16_t>(k / every));
        }
      }
      pair.scan = std::move(kept);
    }
  };
}

void Shuffle(RawRecording& recording) {
  for (RawPair& pair : recording.pairs) {
    std::vector<int> order(pair.scan.points.size());
    std::iota(order.begin(), order.end(), 0);
    Random random(5);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.Below(i)]);
    pair.scan = Chosen(pair.scan, order);
  }
}

Alter WithoutSome(double share) {
  return [share](RawRecording& recording) {
    Random random(6);
    for (RawPair& pair : recording.pairs) {
      std::vector<int> kept;
      for (int i = 0; i < static_cast<int>(pair.scan.points.size()); ++i) {
        if (random.Uniform() >= share) kept.push_back(i);
      }
      pair.scan = Chosen(pair.scan, kept);
    }
  };
}

Alter WithRangeNoise(double sigma_m) {
  return [sigma_m](RawRecording& recording) {
    Random random(7);
    for (RawPair& pair : recording.pairs) {
      for (Eigen::Vector3d& point : pair.scan.points) {
        point *= 1.0 + sigma_m * random.Normal() / std::max(0.5, point.norm());
      }
    }
  };
}

// The same scan in a frame that is rotated about this axis.
Alter InFrameRotated(double angle_deg, const Eigen::Vector3d& axis) {
  return [angle_deg, axis](RawRecording& recording) {
    const Eigen::Quaterniond turn = ExpSo3(angle_deg * kRadPerDeg * axis);
    for (RawPair& pair : recording.pairs) {
      for (Eigen::Vector3d& point : pair.scan.points) point = turn * point;
    }
    recording.cam_from_lidar = recording.cam_from_lidar * Rigid3d{turn, {0, 0, 0}}.Inverse();
  };
}

// Each photo with the scan of another moment.
Alter Exchanged(std::size_t by, bool all) {
  return [by, all](RawRecording& recording) {
    const std::vector<RawPair> pairs = recording.pairs;
    for (std::size_t i = 0; i < (all ? pairs.size() : 1); ++i) {
      recording.pairs[i].scan = pairs[(i + by) % pairs.size()].scan;
    }
  };
}

Alter WithCamera(const std::function<void(Camera&)>& change) {
  return [change](RawRecording& recording) { change(recording.camera); };
}

Alter WithFocalLength(double factor) {
  return WithCamera([factor](Camera& camera) {
    camera.fx_px *= factor;
    camera.fy_px *= factor;
  });
}

}  // namespace

std::vector<SceneAlteration> SceneAlterations() {
  const double pi = std::numbers::pi;
  std::vector<SceneAlteration> all = {
      {"as recorded", [](RawRecording&) {}},
      {"half as bright", OfGreyLevels([](double g) { return 0.5 * g; })},
      {"overexposed 2.5 times", OfGreyLevels([](double g) { return 2.5 * g; })},
      {"gamma 2.2", OfGreyLevels([](double g) { return std::pow(g, 2.2); })},
      {"gamma 0.45", OfGreyLevels([](double g) { return std::pow(g, 0.45); })},
      {"solarised", OfGreyLevels([pi](double g) { return std::sin(pi * g); })},
      {"blur of 2 px", Blurred(2.0)},
      {"noise of 15 grey levels", WithNoise(1.0, 15.0)},
      {"night: a fifteenth of the light, noise 4", WithNoise(1.0 / 15.0, 4.0)},
      {"JPEG of quality 15", Compressed(15)},
      {"half the size", HalveSize},
      {"cropped", CropMiddle},
      {"every 2nd ring", Thinned(2, false)},
      {"every 4th ring", Thinned(4, false)},
      {"every 4th ring, numbered", Thinned(4, true)},
      {"points shuffled", Shuffle},
      {"half of the points lost", WithoutSome(0.5)},
      {"range noise of 5 cm", WithRangeNoise(0.05)},
      {"LiDAR frame x right, y forward", InFrameRotated(90.0, Eigen::Vector3d::UnitZ())},
      {"LiDAR frame y up", InFrameRotated(-90.0, Eigen::Vector3d::UnitX())},
      {"LiDAR frame tilted by 20 deg", InFrameRotated(20.0, Eigen::Vector3d::UnitY())},
      {"one scan of another moment", Exchanged(1, false)}};
  const std::vector<SceneAlteration> refused = {
      {"scans of another moment", Exchanged(1, true), true},
      {"scans of a third moment", Exchanged(3, true), true},
      {"focal length 1 % longer", WithFocalLength(1.01), true},
      {"focal length 3 % longer", WithFocalLength(1.03), true},
      {"focal length 5 % shorter", WithFocalLength(0.95), true},
      {"principal point 10 px off", WithCamera([](Camera& c) { c.cx_px += 10.0; }), true}};
  all.insert(all.end(), refused.begin(), refused.end());
  return all;
}

}  // namespace sextant
