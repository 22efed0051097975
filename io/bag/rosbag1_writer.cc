// SPDX-License-Identifier: Apache-2.0
#include "io/bag/rosbag1_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "base/text/path_text.h"
#include "io/bag/decompress.h"
#include "io/bag/message_writer.h"
#include "io/bag/rosbag1_records.h"
#include "io/cameras/camera_parts.h"
#include "io/output/output_file.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

constexpr std::size_t kChunkSize = 768 * 1024;  // The default of ROS.
constexpr std::size_t kBagHeaderSize = 4096;
constexpr std::int64_t kLastTime = std::int64_t{0xffffffff} * 1'000'000'000;

void AppendField(std::string& header, std::string_view name, std::string_view value) {
  AppendNumber(header, static_cast<std::uint32_t>(name.size() + 1 + value.size()));
  header += name;
  header += '=';
  header += value;
}

template <class Number>
void AppendNumberField(std::string& header, std::string_view name, Number number) {
  std::string value;
  AppendNumber(value, number);
  AppendField(header, name, value);
}

void AppendTime(std::string& out, std::int64_t time_ns) {
  AppendNumber(out, static_cast<std::uint32_t>(time_ns / 1'000'000'000));
  AppendNumber(out, static_cast<std::uint32_t>(time_ns % 1'000'000'000));
}

void AppendTimeField(std::string& header, std::string_view name, std::int64_t time_ns) {
  std::string value;
  AppendTime(value, time_ns);
  AppendField(header, name, value);
}

std::string HeaderOf(BagOp op) {
  std::string header;
  AppendNumberField(header, "op", static_cast<std::uint8_t>(op));
  return header;
}

std::string Record(std::string_view header, std::string_view data) {
  std::string record;
  AppendCounted(record, header);
  AppendCounted(record, data);
  return record;
}

// Padded to a fixed size, so that it can be overwritten once its numbers are known.
std::string BagHeader(std::uint64_t index_pos, std::size_t connections, std::size_t chunks) {
  std::string header = HeaderOf(BagOp::kBagHeader);
  AppendNumberField(header, "index_pos", index_pos);
  AppendNumberField(header, "conn_count", static_cast<std::uint32_t>(connections));
  AppendNumberField(header, "chunk_count", static_cast<std::uint32_t>(chunks));
  const std::size_t padding = kBagHeaderSize - header.size() - 2 * sizeof(std::uint32_t);
  return Record(header, std::string(padding, ' '));
}

struct IndexEntry {
  std::int64_t time_ns = 0;
  std::uint32_t offset = 0;
};

using ChunkIndex = std::map<std::uint32_t, std::vector<IndexEntry>>;  // By connection.

struct ChunkSummary {
  std::uint64_t position = 0;
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;
  std::map<std::uint32_t, std::uint32_t> counts{};
};

std::string ChunkInfo(const ChunkSummary& chunk) {
  std::string header = HeaderOf(BagOp::kChunkInfo);
  AppendNumberField(header, "ver", std::uint32_t{1});
  AppendNumberField(header, "chunk_pos", chunk.position);
  AppendTimeField(header, "start_time", chunk.first_ns);
  AppendTimeField(header, "end_time", chunk.last_ns);
  AppendNumberField(header, "count", static_cast<std::uint32_t>(chunk.counts.size()));
  std::string data;
  for (const auto& [connection, count] : chunk.counts) {
    AppendNumber(data, connection);
    AppendNumber(data, count);
  }
  return Record(header, data);
}

std::string IndexData(std::uint32_t connection, const std::vector<IndexEntry>& entries) {
  std::string header = HeaderOf(BagOp::kIndexData);
  AppendNumberField(header, "ver", std::uint32_t{1});
  AppendNumberField(header, "conn", connection);
  AppendNumberField(header, "count", static_cast<std::uint32_t>(entries.size()));
  std::string data;
  for (const IndexEntry& entry : entries) {
    AppendTime(data, entry.time_ns);
    AppendNumber(data, entry.offset);
  }
  return Record(header, data);
}

std::string ConnectionRecord(std::uint32_t id, std::string_view topic, const Ros1Type& type) {
  std::string header = HeaderOf(BagOp::kConnection);
  AppendNumberField(header, "conn", id);
  AppendField(header, "topic", topic);
  std::string data;
  AppendField(data, "topic", topic);
  AppendField(data, "type", type.name);
  AppendField(data, "md5sum", type.md5);
  AppendField(data, "message_definition", type.definition);
  return Record(header, data);
}

}  // namespace

class Rosbag1Writer::Impl {
 public:
  Impl(std::filesystem::path path, OutputFile file, BagCompression compression)
      : path_(std::move(path)), file_(std::move(file)), compression_(compression) {}

  Expected<void> Begin() { return Put(std::string(kRosbag1Magic) + BagHeader(0, 0, 0)); }

  Expected<void> Write(std::string_view topic, std::int64_t time_ns, std::int64_t stamp_ns,
                       const Ros1Type& type, const std::string& message) {
    for (const std::int64_t time : {time_ns, stamp_ns}) {
      if (time >= 0 && time <= kLastTime) continue;
      return Refuse(topic, fmt::format("expected a time from 0 to 2^32 s, got {} ns", time));
    }
    if (message.size() > std::size_t{1} << 30U) {
      return Refuse(topic, fmt::format("a message of {} bytes is too large", message.size()));
    }
    const auto [place, is_new] = connections_.emplace(
        topic, Connection{static_cast<std::uint32_t>(connections_.size()), &type});
    const Connection& connection = place->second;
    if (connection.type != &type) {
      return Refuse(topic, fmt::format("its type is {}; it cannot carry {} too",
                                       connection.type->name, type.name));
    }
    if (is_new) chunk_ += ConnectionRecord(connection.id, topic, type);
    AddMessage(connection.id, time_ns, message);
    return chunk_.size() < kChunkSize ? Expected<void>() : FinishChunk();
  }

  Expected<void> Close() {
    if (!chunk_.empty()) SEXTANT_RETURN_IF_ERROR(FinishChunk());
    const std::uint64_t index_position = position_;
    std::string index;
    for (const auto& [topic, connection] : connections_) {
      index += ConnectionRecord(connection.id, topic, *connection.type);
    }
    for (const ChunkSummary& chunk : chunks_) index += ChunkInfo(chunk);
    SEXTANT_RETURN_IF_ERROR(Put(index));
    SEXTANT_RETURN_IF_ERROR(file_.WriteAt(
        kRosbag1Magic.size(), BagHeader(index_position, connections_.size(), chunks_.size())));
    return file_.Commit();
  }

 private:
  struct Connection {
    std::uint32_t id = 0;
    const Ros1Type* type = nullptr;
  };

  void AddMessage(std::uint32_t connection, std::int64_t time_ns, std::string_view message) {
    const bool first = index_.empty();
    summary_.first_ns = first ? time_ns : std::min(summary_.first_ns, time_ns);
    summary_.last_ns = first ? time_ns : std::max(summary_.last_ns, time_ns);
    ++summary_.counts[connection];
    index_[connection].push_back({time_ns, static_cast<std::uint32_t>(chunk_.size())});
    std::string header = HeaderOf(BagOp::kMessage);
    AppendNumberField(header, "conn", connection);
    AppendTimeField(header, "time", time_ns);
    chunk_ += Record(header, message);
  }

  Expected<void> FinishChunk() {
    static constexpr std::string_view kNames[] = {"none", "bz2", "lz4"};
    static constexpr Compression kCompressions[] = {Compression::kNone, Compression::kBz2,
                                                    Compression::kLz4};
    const auto which = static_cast<std::size_t>(compression_);
    std::string header = HeaderOf(BagOp::kChunk);
    AppendField(header, "compression", kNames[which]);
    AppendNumberField(header, "size", static_cast<std::uint32_t>(chunk_.size()));
    summary_.position = position_;
    std::string bytes = Record(header, Compress(kCompressions[which], chunk_));
    for (const auto& [connection, entries] : index_) bytes += IndexData(connection, entries);
    chunks_.push_back(std::exchange(summary_, ChunkSummary()));
    index_.clear();
    chunk_.clear();
    return Put(bytes);
  }

  Expected<void> Put(std::string_view bytes) {
    SEXTANT_RETURN_IF_ERROR(file_.Append(bytes));
    position_ += bytes.size();
    return {};
  }

  tl::unexpected<Error> Refuse(std::string_view topic, const std::string& what) const {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("{}: topic {}: {}", PathText(path_), Quoted(topic), what));
  }

  std::filesystem::path path_;
  OutputFile file_;
  BagCompression compression_;
  std::uint64_t position_ = 0;
  std::map<std::string, Connection, std::less<>> connections_;
  std::string chunk_;  // Messages that are not written yet.
  ChunkIndex index_;
  ChunkSummary summary_;
  std::vector<ChunkSummary> chunks_;
};

Rosbag1Writer::Rosbag1Writer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Rosbag1Writer::Rosbag1Writer(Rosbag1Writer&&) noexcept = default;
Rosbag1Writer& Rosbag1Writer::operator=(Rosbag1Writer&&) noexcept = default;
Rosbag1Writer::~Rosbag1Writer() = default;

Expected<Rosbag1Writer> Rosbag1Writer::Create(const std::filesystem::path& path,
                                              BagCompression compression) {
  SEXTANT_ASSIGN_OR_RETURN(OutputFile file, OutputFile::Open(path));
  auto impl = std::make_unique<Impl>(path, std::move(file), compression);
  SEXTANT_RETURN_IF_ERROR(impl->Begin());
  return Rosbag1Writer(std::move(impl));
}

Expected<void> Rosbag1Writer::Write(std::string_view topic, std::int64_t time_ns,
                                    const CloudMessage& message) {
  return impl_->Write(topic, time_ns, message.header.stamp_ns, kPointCloud2Type,
                      Ros1Message(message));
}

Expected<void> Rosbag1Writer::Write(std::string_view topic, std::int64_t time_ns,
                                    const ImageMessage& message) {
  const bool fits =
      message.width_px >= 0 && message.height_px >= 0 &&
      static_cast<std::size_t>(message.height_px) * message.row_bytes == message.data.size();
  if (!fits) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("topic {}: expected {} rows of {} bytes, got {} bytes", Quoted(topic),
                    message.height_px, message.row_bytes, message.data.size()));
  }
  return impl_->Write(topic, time_ns, message.header.stamp_ns, kImageType, Ros1Message(message));
}

Expected<void> Rosbag1Writer::Write(std::string_view topic, std::int64_t time_ns,
                                    const EncodedImageMessage& message) {
  return impl_->Write(topic, time_ns, message.header.stamp_ns, kCompressedImageType,
                      Ros1Message(message));
}

Expected<void> Rosbag1Writer::Write(std::string_view topic, std::int64_t time_ns,
                                    const CameraInfoMessage& message) {
  if (!HasPlaceFor(message.camera)) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("topic {}: CameraInfo cannot state a camera of the model {}: it "
                                 "has no place for xi",
                                 Quoted(topic), RosDistortionOf(message.camera).model));
  }
  return impl_->Write(topic, time_ns, message.header.stamp_ns, kCameraInfoType,
                      Ros1Message(message));
}

Expected<void> Rosbag1Writer::Close() { return impl_->Close(); }

}  // namespace sextant
