// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "geometry/camera.h"
#include "geometry/point_cloud.h"
#include "io/bag/bag.h"

namespace sextant {

/// Time and frame of a measurement.
struct MessageHeader {
  std::int64_t stamp_ns = 0;  ///< Since 1970.
  std::string frame;
};

/// sensor_msgs/PointCloud2, or CustomMsg of Livox' drivers: position, reflectivity and time.
struct CloudMessage {
  MessageHeader header{};
  PointCloud cloud{};
};

/// sensor_msgs/Image.
struct ImageMessage {
  MessageHeader header{};
  int width_px = 0;
  int height_px = 0;
  std::string encoding{};     ///< "mono8", "bgr8", "rgb8", "mono16", "bayer_rggb16" and so on.
  bool big_endian = false;    ///< Byte order of samples of more than one byte.
  std::size_t row_bytes = 0;  ///< Bytes from one row to the next.
  std::string data{};         ///< height_px * row_bytes bytes; half as many again for nv12, nv21.
};

/// sensor_msgs/CompressedImage: a JPEG or PNG file.
struct EncodedImageMessage {
  MessageHeader header{};
  std::string format{};  ///< "jpeg", "png", "bgr8; jpeg compressed bgr8" and so on.
  std::string data{};
};

/// sensor_msgs/CameraInfo.
struct CameraInfoMessage {
  MessageHeader header{};
  Camera camera{};
};

/// Each decodes a message of its kind, of ROS 1 or ROS 2.
/// Errors, which name the topic, the time and the field: kParse for a message that does not match
/// its type (lengths beyond its end, fields beyond a point, inconsistent sizes); kInvalidInput for
/// an invalid camera (never calibrated: K is zero; of a model with xi), and for a scan in
/// millimetres (CheckMetres in io/clouds/cloud_builder.h). Time is linear in the
/// message; memory is at most 40 times it.
Expected<CloudMessage> DecodePointCloud(const BagMessage& message);
Expected<ImageMessage> DecodeImage(const BagMessage& message);
Expected<EncodedImageMessage> DecodeEncodedImage(const BagMessage& message);
Expected<CameraInfoMessage> DecodeCameraInfo(const BagMessage& message);

/// Decodes only the header, of a message of any of the four kinds.
Expected<MessageHeader> DecodeHeader(const BagMessage& message);

/// Whether CameraInfo can state the camera: it has no xi and no alpha.
bool HasPlaceFor(const Camera& camera);

/// "jpg" or "png" according to the first bytes; "bin" for anything else.
std::string ExtensionOf(const EncodedImageMessage& image);

}  // namespace sextant
