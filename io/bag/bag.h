// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// How the messages of a topic are laid out.
enum class MessageEncoding {
  kRos1,     ///< Packed, little endian.
  kCdr,      ///< ROS 2: aligned, of either byte order.
  kUnknown,  ///< Listed, never decoded.
};

/// What a message is to a calibration.
enum class MessageKind { kPointCloud, kImage, kEncodedImage, kCameraInfo, kOther };

struct BagTopic {
  std::string name;
  std::string type;  ///< As ROS 1 writes it: "sensor_msgs/PointCloud2".
  MessageKind kind = MessageKind::kOther;
  MessageEncoding encoding = MessageEncoding::kUnknown;
  std::size_t count = 0;
  std::int64_t first_ns = 0;  ///< When the first message was recorded, since 1970; 0 if none was.
  std::int64_t last_ns = 0;
};

/// One recorded message; its bytes live until the visitor returns.
struct BagMessage {
  const BagTopic* topic = nullptr;
  std::size_t topic_index = 0;
  std::int64_t time_ns = 0;  ///< When it was recorded, since 1970; not the stamp of its header.
  std::string_view data;
};

/// A recording, open for reading. Memory: one chunk of it, and what the caller keeps.
class Bag {
 public:
  /// Receives a message; an error ends the reading.
  using Visitor = std::function<Expected<void>(const BagMessage&)>;

  virtual ~Bag() = default;

  /// "ROS 1 bag", "ROS 2 bag (SQLite)" or "MCAP".
  virtual std::string_view format() const = 0;
  const std::vector<BagTopic>& topics() const { return topics_; }

  /// Shows the messages of the topics with these indices in the order of the file. Errors: kParse,
  /// with the byte or row; whatever the visitor returns.
  virtual Expected<void> Read(const std::vector<std::size_t>& topic_indices,
                              const Visitor& visit) const = 0;

 protected:
  std::vector<BagTopic> topics_;
};

/// Opens a recording of ROS 1 (.bag, version 2.0; chunks plain, bz2 or lz4; with an index or
/// without), ROS 2 (.db3, messages plain or zstd) or MCAP (chunks plain, lz4 or zstd), told apart
/// by the first bytes; or the one such file in a folder, as ROS 2 records. Errors: kIo; kParse,
/// with the byte, for anything else and for a file that is cut short.
Expected<std::unique_ptr<Bag>> OpenBag(const std::filesystem::path& path);

/// Of "sensor_msgs/PointCloud2" and so on.
MessageKind MessageKindOf(std::string_view type);

}  // namespace sextant
