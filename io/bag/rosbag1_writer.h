// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "base/error.h"
#include "io/bag/messages.h"

namespace sextant {

enum class BagCompression { kNone, kBz2, kLz4 };

/// Writes a recording that every tool of ROS 1 reads: a .bag of version 2.0, with its index. The
/// file appears whole, by Close(), or not at all (io/output).
///
/// A topic has one type. `time_ns` is the recording time since 1970, from 0 to 2^32 s.
/// Errors: those of OutputFile; kInvalidInput for a time or stamp outside this range, an image
/// whose data does not match its size, a camera for which CameraInfo has no place, and a topic with
/// messages of two types. After an error, only
/// the destructor may be called.
class Rosbag1Writer {
 public:
  static Expected<Rosbag1Writer> Create(const std::filesystem::path& path,
                                        BagCompression compression = BagCompression::kLz4);
  Rosbag1Writer(Rosbag1Writer&&) noexcept;
  Rosbag1Writer& operator=(Rosbag1Writer&&) noexcept;
  ~Rosbag1Writer();  ///< Without Close(), no file remains.

  /// sensor_msgs/PointCloud2: x, y, z as float32; intensity (float32), ring (uint16) and time
  /// (float32, s) if the cloud has them.
  Expected<void> Write(std::string_view topic, std::int64_t time_ns, const CloudMessage& message);
  Expected<void> Write(std::string_view topic, std::int64_t time_ns, const ImageMessage& message);
  Expected<void> Write(std::string_view topic, std::int64_t time_ns,
                       const EncodedImageMessage& message);
  Expected<void> Write(std::string_view topic, std::int64_t time_ns,
                       const CameraInfoMessage& message);

  /// Writes the index and renames the file to its final name.
  Expected<void> Close();

 private:
  class Impl;
  explicit Rosbag1Writer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
