// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <utility>

#include "base/text/path_text.h"
#include "io/bag/byte_reader.h"
#include "io/bag/decompress.h"
#include "io/bag/open_bytes.h"
#include "io/bag/rosbag1_records.h"
#include "io/bag/topic_table.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

// A chunk of the file.
struct Chunk {
  std::size_t begin = 0;
  Compression compression = Compression::kNone;
  std::size_t size = 0;  // Decompressed.
  std::string_view data;
  bool is_cut = false;  // Its end is missing.
};

// The index of the topic of each connection, by its number.
using Connections = std::map<std::uint32_t, std::size_t>;

class Rosbag1 final : public Bag {
 public:
  Rosbag1(std::string_view bytes, const std::string& file, std::shared_ptr<const void> owner)
      : bytes_(bytes), file_(PathText(file)), owner_(std::move(owner)) {}

  std::string_view format() const override { return "ROS 1 bag"; }

  Expected<void> Open();
  Expected<void> Read(const std::vector<std::size_t>& topic_indices,
                      const Visitor& visit) const override;

 private:
  Expected<void> CheckBagHeader(BagRecords& records);
  Expected<void> TakeRecord(const BagRecords& records, const BagRecord& record);
  Expected<void> TakeCut(const BagRecords& records);
  Expected<void> TakeChunk(const BagRecords& records, const BagRecord& record);
  Expected<void> TakeIndex(const BagRecords& records, const BagRecord& record);
  Expected<void> AddConnection(const BagRecords& records, const BagRecord& record);
  Expected<void> CountIndex(const BagRecords& records);
  Expected<void> CountContents();
  // Calls `take(records, record)` for each record in the chunk.
  template <class Take>
  Expected<void> ForEachRecord(const Chunk& chunk, Take take) const;

  std::string_view bytes_;
  std::string file_;
  std::shared_ptr<const void> owner_;
  std::uint64_t index_position_ = 0;  // 0: the recorder did not close the bag.
  // Connections and summaries of chunks from there on: those that are to come.
  std::uint64_t index_records_ = 0;
  std::vector<Chunk> chunks_;
  TopicTable table_;
  Connections connections_;
  std::map<std::uint32_t, BagTopic> indexed_;  // Counts and times by connection.
};

// Adds the topic of a connection record, whose data is a header with the type.
Expected<void> Rosbag1::AddConnection(const BagRecords& records, const BagRecord& record) {
  const std::optional<std::uint32_t> id = Uint32Field(record.fields, "conn");
  const std::optional<BagFields> description = ParseBagFields(record.data);
  if (!id || !description || !record.fields.contains("topic")) {
    return records.Fail("expected a connection with conn, topic and type");
  }
  const std::size_t topic =
      table_.IndexOf(TextField(record.fields, "topic"), TextField(*description, "type"),
                     MessageEncoding::kRos1, topics_);
  const auto [place, is_new] = connections_.emplace(*id, topic);
  if (!is_new && place->second != topic) {
    return records.Fail(fmt::format("the connection {} has two topics", *id));
  }
  return {};
}

Expected<void> Rosbag1::Open() {
  if (!bytes_.starts_with(kRosbag1Magic)) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: byte 0: expected a ROS 1 bag of version 2.0, got {}; `rosbag "
                                 "fix` converts older versions",
                                 file_, Quoted(bytes_.substr(0, kRosbag1Magic.size()))));
  }
  BagRecords records(bytes_.substr(kRosbag1Magic.size()), kRosbag1Magic.size(), file_);
  SEXTANT_RETURN_IF_ERROR(CheckBagHeader(records));
  while (true) {
    const Expected<std::optional<BagRecord>> record = records.Next();
    if (!record && !records.is_cut()) return tl::unexpected<Error>(record.error());
    if (!record) SEXTANT_RETURN_IF_ERROR(TakeCut(records));
    if (!record || !*record) break;
    SEXTANT_RETURN_IF_ERROR(TakeRecord(records, **record));
  }
  if (!cut_ && index_position_ == 0) {
    cut_ = {.byte = bytes_.size(), .reason = "its recorder did not close it"};
  } else if (!cut_ && (index_position_ > bytes_.size() || index_records_ > 0)) {
    cut_ = {.byte = bytes_.size(), .reason = "the file ends before the end of its index"};
  }
  if (!cut_) return CountIndex(records);
  SEXTANT_RETURN_IF_ERROR(CountContents());
  return RequireMessages(file_, *cut_, topics_);
}

// The file ends within the last record; if that is a chunk, its beginning is read.
Expected<void> Rosbag1::TakeCut(const BagRecords& records) {
  cut_ = {.byte = records.record_begin(), .reason = "the file ends within a record"};
  const std::optional<BagRecord> begun = records.Begun();
  if (!begun || OpOf(begun->fields) != BagOp::kChunk) return {};
  SEXTANT_RETURN_IF_ERROR(TakeChunk(records, *begun));
  chunks_.back().is_cut = true;
  return {};
}

Expected<void> Rosbag1::CountIndex(const BagRecords& records) {
  for (const auto& [id, counted] : indexed_) {
    const auto connection = connections_.find(id);
    if (connection == connections_.end()) {
      return records.Fail(
          fmt::format("the index refers to the connection {}, which is missing", id));
    }
    AddMessages(topics_[connection->second], counted.count, counted.first_ns, counted.last_ns);
  }
  return {};
}

Expected<void> Rosbag1::CheckBagHeader(BagRecords& records) {
  SEXTANT_ASSIGN_OR_RETURN(const std::optional<BagRecord> record, records.Next());
  if (!record || OpOf(record->fields) != BagOp::kBagHeader) {
    return records.Fail("expected the bag's header");
  }
  const BagFields& fields = record->fields;
  if (!TextField(fields, "encryptor").empty()) {
    return records.Fail("this bag is encrypted; decrypt it with ROS first");
  }
  // The recorder sets index_pos when it closes the bag.
  index_position_ = Uint64Field(fields, "index_pos").value_or(0);
  index_records_ = std::uint64_t{Uint32Field(fields, "conn_count").value_or(0)} +
                   Uint32Field(fields, "chunk_count").value_or(0);
  return {};
}

Expected<void> Rosbag1::TakeRecord(const BagRecords& records, const BagRecord& record) {
  const std::optional<BagOp> op = OpOf(record.fields);
  if (!op) return records.Fail("a record has no operation");
  const bool is_of_index = *op == BagOp::kConnection || *op == BagOp::kChunkInfo;
  if (is_of_index && index_records_ > 0) --index_records_;
  if (*op == BagOp::kChunk) return TakeChunk(records, record);
  if (*op == BagOp::kIndexData) return TakeIndex(records, record);
  if (*op == BagOp::kConnection) return AddConnection(records, record);
  return {};
}

Expected<void> Rosbag1::TakeChunk(const BagRecords& records, const BagRecord& record) {
  const Expected<Compression> compression =
      CompressionNamed(TextField(record.fields, "compression"));
  if (!compression) return records.Fail(compression.error().message);
  const std::optional<std::uint32_t> size = Uint32Field(record.fields, "size");
  if (!size) return records.Fail("expected the size of a chunk");
  chunks_.push_back({records.record_begin(), *compression, *size, record.data});
  return {};
}

Expected<void> Rosbag1::TakeIndex(const BagRecords& records, const BagRecord& record) {
  constexpr std::size_t kEntrySize = 12;
  const std::optional<std::uint32_t> id = Uint32Field(record.fields, "conn");
  const std::optional<std::uint32_t> count = Uint32Field(record.fields, "count");
  if (!id || !count || record.data.size() != kEntrySize * *count) {
    return records.Fail("expected an index of conn and count, 12 bytes an entry");
  }
  BagTopic& counted = indexed_[*id];
  ByteReader in(record.data);
  for (std::uint32_t i = 0; i < *count; ++i) {
    const std::int64_t seconds = in.Take<std::uint32_t>();
    const std::int64_t nanoseconds = in.Take<std::uint32_t>();
    in.Take<std::uint32_t>();  // Position in the chunk; not needed to find the messages.
    CountMessage(counted, seconds * 1'000'000'000 + nanoseconds);
  }
  return {};
}

// Without an index, topics and counts come from the chunks.
Expected<void> Rosbag1::CountContents() {
  topics_.clear();
  table_ = {};
  connections_.clear();
  for (const Chunk& chunk : chunks_) {
    SEXTANT_RETURN_IF_ERROR(ForEachRecord(
        chunk, [this](const BagRecords& records, const BagRecord& record) -> Expected<void> {
          const std::optional<BagOp> op = OpOf(record.fields);
          if (op == BagOp::kConnection) return AddConnection(records, record);
          if (op != BagOp::kMessage) return {};
          const auto known = connections_.find(Uint32Field(record.fields, "conn").value_or(~0U));
          const std::optional<std::int64_t> time = TimeField(record.fields, "time");
          if (known != connections_.end() && time) CountMessage(topics_[known->second], *time);
          return {};
        }));
  }
  return {};
}

Expected<void> Rosbag1::Read(const std::vector<std::size_t>& topic_indices,
                             const Visitor& visit) const {
  const std::vector<bool> wanted = WantedTopics(topics_, topic_indices);
  const auto take = [&](const BagRecords& records, const BagRecord& record) -> Expected<void> {
    const BagFields& fields = record.fields;
    if (OpOf(fields) != BagOp::kMessage) return {};
    const std::optional<std::uint32_t> id = Uint32Field(fields, "conn");
    const std::optional<std::int64_t> time = TimeField(fields, "time");
    const auto known = id ? connections_.find(*id) : connections_.end();
    if (!time || known == connections_.end()) {
      return records.Fail("expected a message with its time and a known connection");
    }
    if (!wanted[known->second]) return {};
    return visit({&topics_[known->second], known->second, *time, record.data});
  };
  for (const Chunk& chunk : chunks_) {
    SEXTANT_RETURN_IF_ERROR(ForEachRecord(chunk, take));
  }
  return {};
}

template <class Take>
Expected<void> Rosbag1::ForEachRecord(const Chunk& chunk, Take take) const {
  const std::string where = fmt::format("{}: chunk at byte {}", file_, chunk.begin);
  std::string unpacked;
  std::string_view contents = chunk.data;
  if (chunk.is_cut && chunk.compression != Compression::kNone) {
    unpacked = DecompressBegun(chunk.compression, chunk.data, chunk.size);
    contents = unpacked;
  } else if (!chunk.is_cut &&
             (chunk.compression != Compression::kNone || chunk.size != chunk.data.size())) {
    SEXTANT_ASSIGN_OR_RETURN(
        std::string whole,
        AtPlace(Decompress(chunk.compression, chunk.data, chunk.size), {.file = where}));
    unpacked = std::move(whole);
    contents = unpacked;
  }
  BagRecords records(contents, 0, where);
  while (true) {
    const Expected<std::optional<BagRecord>> record = records.Next();
    if (!record && chunk.is_cut && records.is_cut()) return {};
    if (!record) return tl::unexpected<Error>(record.error());
    if (!*record) return {};
    SEXTANT_RETURN_IF_ERROR(take(records, **record));
  }
}

}  // namespace

Expected<std::unique_ptr<Bag>> OpenRosbag1(std::string_view bytes, const std::string& file,
                                           std::shared_ptr<const void> owner) {
  auto bag = std::make_unique<Rosbag1>(bytes, file, std::move(owner));
  SEXTANT_RETURN_IF_ERROR(bag->Open());
  return std::unique_ptr<Bag>(std::move(bag));
}

}  // namespace sextant
