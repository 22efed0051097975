// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
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

/// The end of a recording that is not whole.
struct BagCut {
  std::uint64_t byte = 0;  ///< What begins here is not read.
  std::string reason{};    ///< "the file ends within a record" and so on.
};

/// A recording, open for reading. It keeps at most one chunk and its index in memory: a chunk takes
/// its decompressed size, at most 256 times the file's and 64 MiB. Opening and each Read() take
/// time linear in the file's size and in what it decompresses to.
class Bag {
 public:
  /// Receives a message; an error stops the reading.
  using Visitor = std::function<Expected<void>(const BagMessage&)>;

  virtual ~Bag() = default;

  /// "ROS 1 bag", "ROS 2 bag (SQLite)" or "MCAP".
  virtual std::string_view format() const = 0;
  const std::vector<BagTopic>& topics() const { return topics_; }

  /// Set if the recording is cut short, or was not closed by its recorder. Its topics, counts and
  /// messages are then those before the cut.
  const std::optional<BagCut>& cut() const { return cut_; }

  /// Passes the messages of the topics with these indices to `visit`, in the order of the file.
  /// Errors: kParse, with the byte or row; those of the visitor.
  virtual Expected<void> Read(const std::vector<std::size_t>& topic_indices,
                              const Visitor& visit) const = 0;

 protected:
  std::vector<BagTopic> topics_;
  std::optional<BagCut> cut_;
};

/// Opens a recording of ROS 1 (.bag, version 2.0; chunks plain, bz2 or lz4; with an index or
/// without), ROS 2 (.db3, messages plain or zstd) or MCAP (chunks plain, lz4 or zstd), recognised
/// by the first bytes; or the only such file in a folder, as ROS 2 records. Of a file that is cut
/// short, everything before the cut is read. Errors: kIo; kParse, with the byte, for anything else,
/// for damage before the end, and for a cut before the first message.
Expected<std::unique_ptr<Bag>> OpenBag(const std::filesystem::path& path);

/// "the file ends within a record (byte N): the M messages before it are read"; empty if the
/// recording is whole.
std::string DescribeCut(const Bag& bag);

/// The kind of a type such as "sensor_msgs/PointCloud2".
MessageKind MessageKindOf(std::string_view type);

}  // namespace sextant
