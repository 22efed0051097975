// SPDX-License-Identifier: Apache-2.0
#include "io/bag/messages.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <vector>

#include "io/bag/message_reader.h"
#include "io/cameras/camera_parts.h"
#include "io/clouds/cloud_builder.h"
#include "io/clouds/scalar_type.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

// sensor_msgs/PointField.
struct PointField {
  std::string name;
  std::size_t offset = 0;
  ScalarType type = ScalarType::kFloat32;
};

// sensor_msgs/PointCloud2 without its header; `data` refers to the message.
struct CloudLayout {
  std::size_t height = 0;
  std::size_t width = 0;
  std::vector<PointField> fields;
  bool big_endian = false;
  std::size_t point_step = 0;
  std::size_t row_step = 0;
  std::string_view data;
};

std::vector<PointField> ReadPointFields(MessageReader& in) {
  constexpr std::size_t kMinSize = 13;  // Length of an empty name, offset, type, count.
  std::vector<PointField> fields(in.Length(kMinSize, "fields"));
  for (PointField& field : fields) {
    field.name = in.String("fields.name");
    field.offset = in.Take<std::uint32_t>("fields.offset");
    const auto type = in.Take<std::uint8_t>("fields.datatype");
    in.Take<std::uint32_t>("fields.count");
    if (type < 1 || type > 8) {
      in.Fail(ErrorCode::kParse, "fields.datatype", fmt::format("expected 1 to 8, got {}", type));
      return {};
    }
    field.type = static_cast<ScalarType>(type);
  }
  return fields;
}

CloudLayout ReadLayout(MessageReader& in) {
  CloudLayout layout;
  layout.height = in.Take<std::uint32_t>("height");
  layout.width = in.Take<std::uint32_t>("width");
  layout.fields = ReadPointFields(in);
  layout.big_endian = in.Take<std::uint8_t>("is_bigendian") != 0;
  layout.point_step = in.Take<std::uint32_t>("point_step");
  layout.row_step = in.Take<std::uint32_t>("row_step");
  layout.data = in.ByteSequence("data");
  return layout;
}

// No product overflows: all factors are below 2^32.
void CheckLayout(const CloudLayout& layout, MessageReader& in) {
  for (const PointField& field : layout.fields) {
    if (field.offset + SizeOf(field.type) <= layout.point_step) continue;
    in.Fail(ErrorCode::kParse, "fields",
            fmt::format("{} ends at byte {} of a point of {} bytes", Quoted(field.name),
                        field.offset + SizeOf(field.type), layout.point_step));
  }
  if (layout.height == 0 || layout.width == 0) return;
  if (layout.width * layout.point_step > layout.row_step ||
      layout.height * layout.row_step > layout.data.size()) {
    in.Fail(ErrorCode::kParse, "data",
            fmt::format("has {} bytes; {} rows of {} points of {} bytes do not fit (row_step {})",
                        layout.data.size(), layout.height, layout.width, layout.point_step,
                        layout.row_step));
  }
}

PointCloud BuildCloud(const CloudLayout& layout, MessageReader& in) {
  std::vector<NamedColumn> names;
  for (const PointField& field : layout.fields) {
    names.push_back({field.name, IsInteger(field.type)});
  }
  const Expected<CloudColumns> columns = FindCloudColumns(names);
  if (!columns) in.Fail(columns.error().code, "fields", columns.error().message);
  if (!in.ok()) return {};
  const std::size_t width = layout.height == 0 ? 0 : layout.width;
  const std::size_t height = layout.width == 0 ? 0 : layout.height;
  CloudBuilder builder(*columns, width * height);
  for (std::size_t row = 0; row < height; ++row) {
    for (std::size_t i = 0; i < width; ++i) {
      const char* point = layout.data.data() + row * layout.row_step + i * layout.point_step;
      const Expected<void> added = builder.Add([&](std::size_t column) {
        const PointField& field = layout.fields[column];
        return LoadScalar(point + field.offset, field.type, layout.big_endian);
      });
      if (added) continue;
      in.Fail(added.error().code, fmt::format("point {}", row * width + i), added.error().message);
      return {};
    }
  }
  return std::move(builder).Finish();
}

// sensor_msgs/PointCloud2 without its header.
PointCloud ReadPointCloud2(MessageReader& in) {
  const CloudLayout layout = ReadLayout(in);
  if (in.ok()) CheckLayout(layout, in);
  return in.ok() ? BuildCloud(layout, in) : PointCloud{};
}

// livox_ros_driver/CustomMsg without its header. Its lines are lasers that scan a rosette, no
// rings.
PointCloud ReadLivoxPoints(MessageReader& in) {
  constexpr std::size_t kPointSize = 19;
  in.Take<std::uint64_t>("timebase");
  in.Take<std::uint32_t>("point_num");
  in.Take<std::uint8_t>("lidar_id");
  for (int i = 0; i < 3; ++i) in.Take<std::uint8_t>("rsvd");
  const std::size_t count = in.Length(kPointSize, "points");
  CloudBuilder builder({.x = 0, .y = 1, .z = 2, .intensity = 3, .time = 4}, count);
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    const double time_s = in.Take<std::uint32_t>("points.offset_time") / 1e9;
    std::array<double, 5> values{};
    for (std::size_t k = 0; k < 3; ++k) {
      values[k] = static_cast<double>(in.Take<float>("points.xyz"));
    }
    values[3] = in.Take<std::uint8_t>("points.reflectivity");
    values[4] = time_s;
    in.Take<std::uint8_t>("points.tag");
    in.Take<std::uint8_t>("points.line");
    const Expected<void> added = builder.Add([&](std::size_t column) { return values[column]; });
    if (!added) in.Fail(added.error().code, "points", added.error().message);
  }
  return std::move(builder).Take();
}

bool IsLivox(std::string_view type) {
  return type.starts_with("livox") && type.ends_with("/CustomMsg");
}

template <class Message>
Expected<Message> Finished(MessageReader& in, Message& message) {
  if (!in.ok()) return in.TakeError();
  return std::move(message);
}

}  // namespace

MessageKind MessageKindOf(std::string_view type) {
  if (type == "sensor_msgs/PointCloud2" || IsLivox(type)) return MessageKind::kPointCloud;
  if (type == "sensor_msgs/Image") return MessageKind::kImage;
  if (type == "sensor_msgs/CompressedImage") return MessageKind::kEncodedImage;
  if (type == "sensor_msgs/CameraInfo") return MessageKind::kCameraInfo;
  return MessageKind::kOther;
}

Expected<MessageHeader> DecodeHeader(const BagMessage& message) {
  MessageReader in(message);
  MessageHeader header = in.Header();
  return Finished(in, header);
}

Expected<CloudMessage> DecodePointCloud(const BagMessage& message) {
  MessageReader in(message);
  CloudMessage decoded;
  decoded.header = in.Header();
  decoded.cloud = IsLivox(message.topic->type) ? ReadLivoxPoints(in) : ReadPointCloud2(in);
  const Expected<void> metres = in.ok() ? CheckMetres(decoded.cloud) : Expected<void>();
  if (!metres) in.Fail(metres.error().code, "points", metres.error().message);
  return Finished(in, decoded);
}

Expected<ImageMessage> DecodeImage(const BagMessage& message) {
  constexpr std::uint32_t kMaxSide = 1U << 20;
  MessageReader in(message);
  ImageMessage decoded;
  decoded.header = in.Header();
  const auto height = in.Take<std::uint32_t>("height");
  const auto width = in.Take<std::uint32_t>("width");
  decoded.encoding = in.String("encoding");
  decoded.big_endian = in.Take<std::uint8_t>("is_bigendian") != 0;
  decoded.row_bytes = in.Take<std::uint32_t>("step");
  const std::string_view data = in.ByteSequence("data");
  // Planes of half the resolution follow: two samples of colour for each four of brightness.
  const bool has_planes = decoded.encoding == "nv12" || decoded.encoding == "nv21";
  const std::size_t rows = has_planes ? height + height / 2 : height;
  if (in.ok() && (width > kMaxSide || height > kMaxSide || decoded.row_bytes < width ||
                  rows * decoded.row_bytes != data.size())) {
    in.Fail(ErrorCode::kParse, "data",
            fmt::format("has {} bytes, expected {} rows of {} bytes for {} pixels each",
                        data.size(), rows, decoded.row_bytes, width));
  }
  if (in.ok()) {
    decoded.width_px = static_cast<int>(width);
    decoded.height_px = static_cast<int>(height);
    decoded.data = std::string(data);
  }
  return Finished(in, decoded);
}

Expected<EncodedImageMessage> DecodeEncodedImage(const BagMessage& message) {
  MessageReader in(message);
  EncodedImageMessage decoded;
  decoded.header = in.Header();
  decoded.format = in.String("format");
  decoded.data = std::string(in.ByteSequence("data"));
  return Finished(in, decoded);
}

Expected<CameraInfoMessage> DecodeCameraInfo(const BagMessage& message) {
  constexpr std::int64_t kMaxSide = 1 << 20;
  MessageReader in(message);
  CameraInfoMessage decoded;
  decoded.header = in.Header();
  const std::int64_t height = in.Take<std::uint32_t>("height");
  const std::int64_t width = in.Take<std::uint32_t>("width");
  const std::string model = in.String("distortion_model");
  std::vector<double> distortion(in.Length(sizeof(double), "D"));
  for (double& value : distortion) value = in.Take<double>("D");
  CameraParts parts{.distortion = distortion, .model = model};
  for (double& value : parts.matrix) value = in.Take<double>("K");
  if (in.ok() && (width > kMaxSide || height > kMaxSide)) {
    in.Fail(ErrorCode::kParse, "width",
            fmt::format("expected the size of an image, got {} x {}", width, height));
  }
  if (in.ok() && std::all_of(parts.matrix.begin(), parts.matrix.end(),
                             [](double value) { return value == 0.0; })) {
    in.Fail(ErrorCode::kInvalidInput, "K", "is zero: this camera was never calibrated");
  }
  if (!in.ok()) return in.TakeError();
  parts.width_px = static_cast<int>(width);
  parts.height_px = static_cast<int>(height);
  const Expected<Camera> camera = CameraFromParts(parts);
  if (!camera) {
    in.Fail(camera.error().code, "camera", camera.error().message);
    return in.TakeError();
  }
  if (!HasPlaceFor(*camera)) {
    in.Fail(
        ErrorCode::kInvalidInput, "distortion_model",
        fmt::format("is {}, whose xi this message does not have; take the intrinsics from a file",
                    model));
    return in.TakeError();
  }
  decoded.camera = *camera;
  return decoded;
}

bool HasPlaceFor(const Camera& camera) {
  return camera.model != CameraModel::kOmnidirectional &&
         camera.model != CameraModel::kDoubleSphere;
}

std::string ExtensionOf(const EncodedImageMessage& image) {
  if (image.data.starts_with("\xff\xd8\xff")) return "jpg";
  if (image.data.starts_with("\x89PNG")) return "png";
  return "bin";
}

}  // namespace sextant
