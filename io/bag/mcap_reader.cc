// SPDX-License-Identifier: Apache-2.0
// MCAP, mcap.dev/spec: records of an operation code, a length and the content.
#include <fmt/core.h>

#include <functional>
#include <limits>
#include <optional>
#include <unordered_map>

#include "base/text/path_text.h"
#include "io/bag/byte_reader.h"
#include "io/bag/decompress.h"
#include "io/bag/open_bytes.h"
#include "io/bag/topic_table.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kMagic = "\x89MCAP0\r\n"sv;

enum class McapOp : std::uint8_t {
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kDataEnd = 15,
};

MessageEncoding EncodingNamed(std::string_view name) {
  if (name == "cdr") return MessageEncoding::kCdr;
  if (name == "ros1") return MessageEncoding::kRos1;
  return MessageEncoding::kUnknown;
}

// The schemas and channels of the records read so far.
struct Channels {
  std::unordered_map<std::uint16_t, std::string> types;   // Type of each schema.
  std::unordered_map<std::uint16_t, std::size_t> topics;  // Index of the topic of each channel.
};

// How a sequence of records ends.
struct RecordsEnd {
  bool is_marked = false;  // By a record of its own.
  bool is_cut = false;     // Within this record, whose content is what is left:
  McapOp op = McapOp::kDataEnd;
  std::string_view content{};
  std::size_t begin = 0;
};

// Calls `take(op, content, position)` for each whole record in `bytes`.
template <class Take>
Expected<RecordsEnd> ForEachMcapRecord(std::string_view bytes, Take take) {
  ByteReader in(bytes);
  while (in.bytes_left() > 0) {
    const std::size_t begin = in.position();
    const auto op = static_cast<McapOp>(in.Take<std::uint8_t>());
    const auto length = in.Take<std::uint64_t>();
    if (!in.ok() || length > in.bytes_left()) {
      const std::string_view left = in.ok() ? in.Bytes(in.bytes_left()) : std::string_view();
      return RecordsEnd{.is_cut = true, .op = op, .content = left, .begin = begin};
    }
    if (op == McapOp::kDataEnd) return RecordsEnd{.is_marked = true};
    SEXTANT_RETURN_IF_ERROR(take(op, in.Bytes(length), begin));
  }
  return RecordsEnd{};
}

class Mcap final : public Bag {
 public:
  Mcap(std::string_view bytes, const std::string& file, std::shared_ptr<const void> owner)
      : bytes_(bytes), file_(PathText(file)), owner_(std::move(owner)) {}

  std::string_view format() const override { return "MCAP"; }

  Expected<void> Open() {
    if (!bytes_.starts_with(kMagic)) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("{}: byte 0: expected MCAP of version 0", file_));
    }
    const TopicOf add = [this](const std::string& name, const std::string& type,
                               MessageEncoding encoding) {
      return table_.IndexOf(name, type, encoding, topics_);
    };
    SEXTANT_ASSIGN_OR_RETURN(const RecordsEnd end,
                             Walk(add, [this](const BagMessage& message) -> Expected<void> {
                               CountMessage(topics_[message.topic_index], message.time_ns);
                               return {};
                             }));
    if (end.is_cut) {
      cut_ = {.byte = end.begin + kMagic.size(), .reason = "the file ends within a record"};
    } else if (!end.is_marked) {
      cut_ = {.byte = bytes_.size(), .reason = "its recorder did not close it"};
    }
    return cut_ ? RequireMessages(file_, *cut_, topics_) : Expected<void>();
  }

  Expected<void> Read(const std::vector<std::size_t>& topic_indices,
                      const Visitor& visit) const override {
    const std::vector<bool> wanted = WantedTopics(topics_, topic_indices);
    const TopicOf find = [this](const std::string& name, const std::string& type, MessageEncoding) {
      return table_.Find(name, type).value_or(0);
    };
    const Expected<RecordsEnd> end = Walk(find, [&](const BagMessage& message) {
      return wanted[message.topic_index] ? visit(message) : Expected<void>();
    });
    if (!end) return tl::unexpected<Error>(end.error());
    return {};
  }

 private:
  // The index of the topic of this name and type.
  using TopicOf =
      std::function<std::size_t(const std::string&, const std::string&, MessageEncoding)>;

  tl::unexpected<Error> Fail(const std::string& where, std::size_t byte,
                             std::string_view what) const {
    return MakeError(ErrorCode::kParse, fmt::format("{}: byte {}: {}", where, byte, what));
  }

  // Visits all messages in the order of the file, those in the beginning of a chunk that is cut
  // included.
  Expected<RecordsEnd> Walk(const TopicOf& topic_of, const Visitor& visit) const {
    Channels channels;
    const auto take = [&](const std::string& where, McapOp op, std::string_view content,
                          std::size_t begin) -> Expected<void> {
      if (op == McapOp::kSchema) return TakeSchema(where, content, begin, channels);
      if (op == McapOp::kChannel) return TakeChannel(where, content, begin, topic_of, channels);
      if (op == McapOp::kMessage) return TakeMessage(where, content, begin, channels, visit);
      return {};
    };
    const auto take_chunk = [&](std::string_view content, std::size_t begin,
                                bool is_cut) -> Expected<void> {
      const std::string where = fmt::format("{}: chunk at byte {}", file_, begin);
      SEXTANT_ASSIGN_OR_RETURN(const std::string inside, Unpack(where, content, is_cut));
      const Expected<RecordsEnd> end =
          ForEachMcapRecord(inside, [&](McapOp op, std::string_view record, std::size_t at) {
            return take(where, op, record, at);
          });
      if (!end) return tl::unexpected<Error>(end.error());
      if (!end->is_cut || is_cut) return {};
      return Fail(where, end->begin, "a record extends beyond the end of the chunk");
    };
    SEXTANT_ASSIGN_OR_RETURN(
        const RecordsEnd end,
        ForEachMcapRecord(bytes_.substr(kMagic.size()),
                          [&](McapOp op, std::string_view content, std::size_t at) {
                            const std::size_t begin = at + kMagic.size();
                            return op == McapOp::kChunk ? take_chunk(content, begin, false)
                                                        : take(file_, op, content, begin);
                          }));
    if (end.is_cut && end.op == McapOp::kChunk) {
      SEXTANT_RETURN_IF_ERROR(take_chunk(end.content, end.begin + kMagic.size(), true));
    }
    return end;
  }

  // The records in a chunk; of one that is cut, as much as can be decompressed.
  Expected<std::string> Unpack(const std::string& where, std::string_view content,
                               bool is_cut) const {
    ByteReader in(content);
    in.Take<std::uint64_t>();  // First and last time.
    in.Take<std::uint64_t>();
    const auto size = in.Take<std::uint64_t>();
    in.Take<std::uint32_t>();  // Checksum; 0 if the recorder computed none.
    const std::string_view name = in.Counted<std::uint32_t>();
    const auto length = in.Take<std::uint64_t>();
    if (is_cut && !in.ok()) return std::string();
    const std::string_view data = in.Bytes(is_cut ? in.bytes_left() : length);
    if (!in.ok()) return Fail(where, 0, "the chunk's parts extend beyond its length");
    const Expected<Compression> compression = CompressionNamed(name);
    if (!compression) return Fail(where, 0, compression.error().message);
    if (is_cut) return DecompressBegun(*compression, data, size);
    Expected<std::string> inside = Decompress(*compression, data, size);
    if (!inside) return Fail(where, 0, inside.error().message);
    return inside;
  }

  Expected<void> TakeSchema(const std::string& where, std::string_view content, std::size_t begin,
                            Channels& channels) const {
    ByteReader in(content);
    const auto id = in.Take<std::uint16_t>();
    const std::string_view name = in.Counted<std::uint32_t>();
    if (!in.ok()) return Fail(where, begin, "expected a schema");
    channels.types[id] = Ros1TypeName(std::string(name));
    return {};
  }

  Expected<void> TakeChannel(const std::string& where, std::string_view content, std::size_t begin,
                             const TopicOf& topic_of, Channels& channels) const {
    ByteReader in(content);
    const auto id = in.Take<std::uint16_t>();
    const auto schema = in.Take<std::uint16_t>();
    const std::string_view topic = in.Counted<std::uint32_t>();
    const std::string_view encoding = in.Counted<std::uint32_t>();
    if (!in.ok()) return Fail(where, begin, "expected a channel");
    const auto type = channels.types.find(schema);
    channels.topics[id] =
        topic_of(std::string(topic), type == channels.types.end() ? "" : type->second,
                 EncodingNamed(encoding));
    return {};
  }

  Expected<void> TakeMessage(const std::string& where, std::string_view content, std::size_t begin,
                             const Channels& channels, const Visitor& visit) const {
    ByteReader in(content);
    const auto channel = channels.topics.find(in.Take<std::uint16_t>());
    in.Take<std::uint32_t>();  // Sequence number.
    const auto time = in.Take<std::uint64_t>();
    in.Take<std::uint64_t>();  // Time of publication.
    if (!in.ok() || channel == channels.topics.end() ||
        time > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      return Fail(where, begin, "expected a message of a known channel, with its time");
    }
    return visit({&topics_[channel->second], channel->second, static_cast<std::int64_t>(time),
                  content.substr(in.position())});
  }

  std::string_view bytes_;
  std::string file_;
  std::shared_ptr<const void> owner_;
  TopicTable table_;
};

}  // namespace

Expected<std::unique_ptr<Bag>> OpenMcap(std::string_view bytes, const std::string& file,
                                        std::shared_ptr<const void> owner) {
  auto bag = std::make_unique<Mcap>(bytes, file, std::move(owner));
  SEXTANT_RETURN_IF_ERROR(bag->Open());
  return std::unique_ptr<Bag>(std::move(bag));
}

}  // namespace sextant
