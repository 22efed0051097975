// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cmath>
#include <cstddef>
#include <opencv2/core.hpp>
#include <string>

#include "calibrate/observe/photo_file.h"
#include "cli/recordings.h"
#include "io/bag/rosbag1_writer.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/pcd_file.h"

namespace sextant::cli {
namespace {

// In ROS, time zero means no time, and its tools skip messages with it.
constexpr double kSessionStart_s = 1.0;
// ROS 1 counts seconds in 32 bits.
constexpr double kLongestSession_s = 4e9;

std::int64_t StampOf(const ScanTruth& scan) {
  return std::llround(1e9 * (kSessionStart_s + scan.start_time_s));
}

Expected<CloudMessage> ScanMessage(const std::filesystem::path& file, std::int64_t stamp_ns) {
  SEXTANT_ASSIGN_OR_RETURN(PointCloud cloud, ReadPcd(file));
  return CloudMessage{{stamp_ns, "lidar"}, std::move(cloud)};
}

Expected<ImageMessage> GreyMessage(const std::filesystem::path& file, const MessageHeader& header) {
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat image, ReadImage(file));
  if (image.type() != CV_8UC1) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("{}: expected an image of 8-bit grey, as the simulation writes; remove it and "
                    "simulate again",
                    file.string()));
  }
  ImageMessage message;
  message.header = header;
  message.width_px = image.cols;
  message.height_px = image.rows;
  message.encoding = "mono8";
  message.row_bytes = static_cast<std::size_t>(image.cols);
  for (int row = 0; row < image.rows; ++row) {
    message.data.append(image.ptr<char>(row), message.row_bytes);
  }
  return message;
}

class SessionRecorder {
 public:
  SessionRecorder(std::filesystem::path folder, const Scene& scene, Rosbag1Writer writer)
      : folder_(std::move(folder)), scene_(scene), writer_(std::move(writer)) {}

  Expected<void> Record(const std::vector<ScanTruth>& scans) {
    for (const SceneCamera& camera : scene_.cameras) {
      SEXTANT_ASSIGN_OR_RETURN(const Camera camera_info,
                               ReadCamera(folder_ / (camera.name + "_info.yaml")));
      cameras_.push_back(camera_info);
    }
    for (const ScanTruth& scan : scans) {
      if (Expected<void> ok = RecordScan(scan); !ok) return ok;
    }
    return writer_.Close();
  }

 private:
  Expected<void> RecordScan(const ScanTruth& scan) {
    const std::int64_t stamp_ns = StampOf(scan);
    SEXTANT_ASSIGN_OR_RETURN(const CloudMessage points,
                             ScanMessage(folder_ / scan.scan_file, stamp_ns));
    Expected<void> ok = writer_.Write("/lidar/points", stamp_ns, points);
    for (std::size_t i = 0; ok && i < cameras_.size(); ++i) ok = RecordCamera(scan, i, stamp_ns);
    return ok;
  }

  Expected<void> RecordCamera(const ScanTruth& scan, std::size_t camera, std::int64_t stamp_ns) {
    const std::string& name = scene_.cameras[camera].name;
    const MessageHeader header = {stamp_ns, name + "_optical"};
    SEXTANT_ASSIGN_OR_RETURN(const ImageMessage image,
                             GreyMessage(folder_ / scan.image_files[camera], header));
    Expected<void> ok = writer_.Write("/" + name + "/image_raw", stamp_ns, image);
    if (!ok) return ok;
    return writer_.Write("/" + name + "/camera_info", stamp_ns,
                         CameraInfoMessage{header, cameras_[camera]});
  }

  std::filesystem::path folder_;
  const Scene& scene_;
  Rosbag1Writer writer_;
  std::vector<Camera> cameras_;
};

}  // namespace

Expected<void> CheckSessionBag(const SessionOptions& options) {
  if (options.level != SessionLevel::kFull) {
    return MakeError(ErrorCode::kInvalidOption,
                     "--bag: only the level full has scans and images to record");
  }
  if (options.scans * options.interval_s > kLongestSession_s) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("--bag: ROS counts time up to {} s, and {} scans, one each {} s, "
                                 "take longer",
                                 kLongestSession_s, options.scans, options.interval_s));
  }
  return {};
}

Expected<void> WriteSessionBag(const std::filesystem::path& folder, const Scene& scene,
                               const std::vector<ScanTruth>& scans) {
  SEXTANT_ASSIGN_OR_RETURN(Rosbag1Writer writer, Rosbag1Writer::Create(folder / kSessionBag));
  return SessionRecorder(folder, scene, std::move(writer)).Record(scans);
}

}  // namespace sextant::cli
