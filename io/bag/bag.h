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

/// How the messages of a topic are serialised.
enum class MessageEncoding {
  kRos1,     ///< Packed, little endian.
  kCdr,      ///< ROS 2: aligned, either byte order.
  kUnknown,  ///< The topic is listed, but its messages cannot be decoded.
};

/// The kinds of messages that a calibration uses.
enum class MessageKind { kPointCloud, kImage, kEncodedImage, kCameraInfo, kOther };

struct BagTopic {
  std::string name;
  std::string type;  ///< As ROS 1 writes it: "sensor_msgs/PointCloud2".
  MessageKind kind = MessageKind::kOther;
  MessageEncoding encoding = MessageEncoding::kUnknown;
  std::size_t count = 0;
  std::int64_t first_ns = 0;  ///< Recording time of the first message since 1970; 0 if none.
  std::int64_t last_ns = 0;
};

/// One recorded message; its bytes are valid until the visitor returns.
struct BagMessage {
  const BagTopic* topic = nullptr;
  std::size_t topic_index = 0;
  std::int64_t time_ns = 0;  ///< Recording time since 1970; not the stamp of its header.
  std::string_view data;
};

/// A recording, open for reading. It keeps at most one chunk in memory.
class Bag {
 public:
  /// Receives a message; an error stops the reading.
  using Visitor = std::function<Expected<void>(const BagMessage&)>;

  virtual ~Bag() = default;

  /// "ROS 1 bag", "ROS 2 bag (SQLite)" or "MCAP".
  virtual std::string_view format() const = 0;
  const std::vector<BagTopic>& topics() const { return topics_; }

  /// Passes the messages of the topics with these indices to `visit`, in the order of the file.
  /// Errors: kParse, with the byte or row; those of the visitor.
  virtual Expected<void> Read(const std::vector<std::size_t>& topic_indices,
                              const Visitor& visit) const = 0;

 protected:
  std::vector<BagTopic> topics_;
};

/// Opens a recording of ROS 1 (.bag, version 2.0; chunks plain, bz2 or lz4; with an index or
/// without), ROS 2 (.db3, messages plain or zstd) or MCAP (chunks plain, lz4 or zstd), recognised
/// by the first bytes; or the only such file in a folder, as ROS 2 records. Errors: kIo; kParse,
/// with the byte, for anything else and for a file that is cut short.
Expected<std::unique_ptr<Bag>> OpenBag(const std::filesystem::path& path);

/// The kind of a type such as "sensor_msgs/PointCloud2".
MessageKind MessageKindOf(std::string_view type);

}  // namespace sextant
