// SPDX-License-Identifier: Apache-2.0
#include "io/bag/message_writer.h"

#include <algorithm>
#include <vector>

#include "io/cameras/camera_parts.h"
#include "io/clouds/scalar_type.h"

namespace sextant {
namespace {

#define SEXTANT_HEADER_DEFINITION                                                      \
  "================================================================================\n" \
  "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"

void AppendHeader(std::string& out, const MessageHeader& header) {
  AppendNumber(out, std::uint32_t{0});
  AppendNumber(out, static_cast<std::uint32_t>(header.stamp_ns / 1'000'000'000));
  AppendNumber(out, static_cast<std::uint32_t>(header.stamp_ns % 1'000'000'000));
  AppendCounted(out, header.frame);
}

// Appends the description of a field, sensor_msgs/PointField, and adds its size to `step`.
void AppendField(std::string& out, std::string_view name, ScalarType type, std::uint32_t& step) {
  AppendCounted(out, name);
  AppendNumber(out, step);
  AppendNumber(out, static_cast<std::uint8_t>(type));
  AppendNumber(out, std::uint32_t{1});
  step += static_cast<std::uint32_t>(SizeOf(type));
}

std::uint32_t AppendFields(std::string& out, const PointCloud& cloud) {
  const bool has_intensity = !cloud.intensity.empty();
  const bool has_ring = !cloud.ring.empty();
  const bool has_time = !cloud.time_s.empty();
  AppendNumber(out, static_cast<std::uint32_t>(3 + has_intensity + has_ring + has_time));
  std::uint32_t step = 0;
  for (const char* name : {"x", "y", "z"}) AppendField(out, name, ScalarType::kFloat32, step);
  if (has_intensity) AppendField(out, "intensity", ScalarType::kFloat32, step);
  if (has_ring) AppendField(out, "ring", ScalarType::kUint16, step);
  if (has_time) AppendField(out, "time", ScalarType::kFloat32, step);
  return step;
}

void AppendPoints(std::string& out, const PointCloud& cloud) {
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    for (const double value : cloud.points[i]) AppendNumber(out, static_cast<float>(value));
    if (!cloud.intensity.empty()) AppendNumber(out, cloud.intensity[i]);
    if (!cloud.ring.empty()) AppendNumber(out, cloud.ring[i]);
    if (!cloud.time_s.empty()) AppendNumber(out, static_cast<float>(cloud.time_s[i]));
  }
}

}  // namespace

// ROS computes the MD5 from the definition without comments, so these are the types of ROS.
const Ros1Type kPointCloud2Type = {
    "sensor_msgs/PointCloud2", "1158d486dd51d683ce2f1be655c3c181",
    "Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\n"
    "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n" SEXTANT_HEADER_DEFINITION
    "================================================================================\n"
    "MSG: sensor_msgs/PointField\nuint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\n"
    "uint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\n"
    "uint32 offset\nuint8 datatype\nuint32 count\n"};

const Ros1Type kImageType = {
    "sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743",
    "Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n"
    "uint32 step\nuint8[] data\n" SEXTANT_HEADER_DEFINITION};

const Ros1Type kCompressedImageType = {
    "sensor_msgs/CompressedImage", "8f7a12909da2c9d3332d540a0977563f",
    "Header header\nstring format\nuint8[] data\n" SEXTANT_HEADER_DEFINITION};

const Ros1Type kCameraInfoType = {
    "sensor_msgs/CameraInfo", "c9a58c1b0b154e0e6da7578cb991d214",
    "Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] D\n"
    "float64[9] K\nfloat64[9] R\nfloat64[12] P\nuint32 binning_x\nuint32 binning_y\n"
    "RegionOfInterest roi\n" SEXTANT_HEADER_DEFINITION
    "================================================================================\n"
    "MSG: sensor_msgs/RegionOfInterest\nuint32 x_offset\nuint32 y_offset\nuint32 height\n"
    "uint32 width\nbool do_rectify\n"};

void AppendCounted(std::string& out, std::string_view bytes) {
  AppendNumber(out, static_cast<std::uint32_t>(bytes.size()));
  out += bytes;
}

std::string Ros1Message(const CloudMessage& message) {
  const PointCloud& cloud = message.cloud;
  const auto count = static_cast<std::uint32_t>(cloud.points.size());
  std::string out;
  AppendHeader(out, message.header);
  AppendNumber(out, std::uint32_t{1});  // height
  AppendNumber(out, count);             // width
  const std::uint32_t step = AppendFields(out, cloud);
  AppendNumber(out, std::uint8_t{0});  // is_bigendian
  AppendNumber(out, step);
  AppendNumber(out, step * count);  // row_step
  AppendNumber(out, step * count);  // length of data
  out.reserve(out.size() + std::size_t{step} * count + 1);
  AppendPoints(out, cloud);
  const bool is_dense = std::all_of(cloud.points.begin(), cloud.points.end(),
                                    [](const Eigen::Vector3d& p) { return p.allFinite(); });
  AppendNumber(out, static_cast<std::uint8_t>(is_dense));
  return out;
}

std::string Ros1Message(const ImageMessage& message) {
  std::string out;
  AppendHeader(out, message.header);
  AppendNumber(out, static_cast<std::uint32_t>(message.height_px));
  AppendNumber(out, static_cast<std::uint32_t>(message.width_px));
  AppendCounted(out, message.encoding);
  AppendNumber(out, static_cast<std::uint8_t>(message.big_endian));
  AppendNumber(out, static_cast<std::uint32_t>(message.row_bytes));
  AppendCounted(out, message.data);
  return out;
}

std::string Ros1Message(const EncodedImageMessage& message) {
  std::string out;
  AppendHeader(out, message.header);
  AppendCounted(out, message.format);
  AppendCounted(out, message.data);
  return out;
}

std::string Ros1Message(const CameraInfoMessage& message) {
  const Camera& camera = message.camera;
  const auto [model, count] = RosDistortionOf(camera);
  const double fx = camera.fx_px;
  const double fy = camera.fy_px;
  const double cx = camera.cx_px;
  const double cy = camera.cy_px;
  std::string out;
  AppendHeader(out, message.header);
  AppendNumber(out, static_cast<std::uint32_t>(camera.height_px));
  AppendNumber(out, static_cast<std::uint32_t>(camera.width_px));
  AppendCounted(out, model);
  AppendNumber(out, static_cast<std::uint32_t>(count));
  for (std::size_t i = 0; i < count; ++i) AppendNumber(out, camera.distortion[i]);
  for (const double value : {fx, camera.skew_px, cx, 0.0, fy, cy, 0.0, 0.0, 1.0})
    AppendNumber(out, value);
  for (const double value : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) AppendNumber(out, value);
  for (const double value : {fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0}) {
    AppendNumber(out, value);
  }
  out.append(6 * sizeof(std::uint32_t) + 1, '\0');  // Binning and region of interest: none.
  return out;
}

}  // namespace sextant
