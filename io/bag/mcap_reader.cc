// SPDX-License-Identifier: Apache-2.0
// MCAP, mcap.dev/spec: records of an operation code, a length and the content.
#include <fmt/core.h>

#include <limits>
#include <map>
#include <optional>

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
  std::map<std::uint16_t, std::string> types;   // Type of each schema.
  std::map<std::uint16_t, std::size_t> topics;  // Index of the topic of each channel.
};

class Mcap final : public Bag {
 public:
  Mcap(std::string_view bytes, const std::string& file, std::shared_ptr<const void> owner)
      : bytes_(bytes), file_(Printable(file, 200)), owner_(std::move(owner)) {}

  std::string_view format() const override { return "MCAP"; }

  Expected<void> Open() {
    if (!bytes_.starts_with(kMagic)) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("{}: byte 0: expected MCAP of version 0", file_));
    }
    return Walk(topics_, [this](const BagMessage& message) -> Expected<void> {
      CountMessage(topics_[message.topic_index], message.time_ns);
      return {};
    });
  }

  Expected<void> Read(const std::vector<std::size_t>& topic_indices,
                      const Visitor& visit) const override {
    const std::vector<bool> wanted = WantedTopics(topics_, topic_indices);
    std::vector<BagTopic> topics = topics_;
    return Walk(topics, [&](const BagMessage& message) -> Expected<void> {
      return wanted[message.topic_index] ? visit(message) : Expected<void>();
    });
  }

 private:
  // Calls `take(op, content, position)` for each record in `bytes`.
  template <class Take>
  Expected<void> ForEachRecord(std::string_view bytes, const std::string& where, Take take) const {
    ByteReader in(bytes);
    while (in.bytes_left() > 0) {
      const std::size_t begin = in.position();
      const auto op = static_cast<McapOp>(in.Take<std::uint8_t>());
      const std::string_view content = in.Counted<std::uint64_t>();
      if (!in.ok()) {
        return Fail(where, begin,
                    "a record extends beyond the end: the recording is cut short (`mcap recover` "
                    "may repair it)");
      }
      if (op == McapOp::kDataEnd) return {};
      SEXTANT_RETURN_IF_ERROR(take(op, content, begin));
    }
    return {};
  }

  tl::unexpected<Error> Fail(const std::string& where, std::size_t byte,
                             std::string_view what) const {
    return MakeError(ErrorCode::kParse, fmt::format("{}: byte {}: {}", where, byte, what));
  }

  // Visits all messages in the order of the file; new topics are added to `topics`.
  Expected<void> Walk(std::vector<BagTopic>& topics, const Visitor& visit) const {
    Channels channels;
    const auto take = [&](const std::string& where, McapOp op, std::string_view content,
                          std::size_t begin) -> Expected<void> {
      if (op == McapOp::kSchema) return TakeSchema(where, content, begin, channels);
      if (op == McapOp::kChannel) return TakeChannel(where, content, begin, channels, topics);
      if (op == McapOp::kMessage)
        return TakeMessage(where, content, begin, channels, topics, visit);
      return {};
    };
    const std::string_view records = bytes_.substr(kMagic.size());
    return ForEachRecord(
        records, file_,
        [&](McapOp op, std::string_view content, std::size_t begin) -> Expected<void> {
          if (op != McapOp::kChunk) return take(file_, op, content, begin + kMagic.size());
          const std::string where =
              fmt::format("{}: chunk at byte {}", file_, begin + kMagic.size());
          SEXTANT_ASSIGN_OR_RETURN(const std::string inside, Unpack(where, content));
          return ForEachRecord(inside, where,
                               [&](McapOp inner, std::string_view record, std::size_t at) {
                                 return take(where, inner, record, at);
                               });
        });
  }

  Expected<std::string> Unpack(const std::string& where, std::string_view content) const {
    ByteReader in(content);
    in.Take<std::uint64_t>();  // First and last time.
    in.Take<std::uint64_t>();
    const auto size = in.Take<std::uint64_t>();
    in.Take<std::uint32_t>();  // Checksum; 0 if the recorder computed none.
    const std::string_view name = in.Counted<std::uint32_t>();
    const std::string_view data = in.Counted<std::uint64_t>();
    if (!in.ok()) return Fail(where, 0, "the chunk's parts extend beyond its length");
    const Expected<Compression> compression = CompressionNamed(name);
    if (!compression) return Fail(where, 0, compression.error().message);
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
                             Channels& channels, std::vector<BagTopic>& topics) const {
    ByteReader in(content);
    const auto id = in.Take<std::uint16_t>();
    const auto schema = in.Take<std::uint16_t>();
    const std::string_view topic = in.Counted<std::uint32_t>();
    const std::string_view encoding = in.Counted<std::uint32_t>();
    if (!in.ok()) return Fail(where, begin, "expected a channel");
    const auto type = channels.types.find(schema);
    channels.topics[id] =
        TopicIndex(topics, std::string(topic), type == channels.types.end() ? "" : type->second,
                   EncodingNamed(encoding));
    return {};
  }

  Expected<void> TakeMessage(const std::string& where, std::string_view content, std::size_t begin,
                             const Channels& channels, const std::vector<BagTopic>& topics,
                             const Visitor& visit) const {
    ByteReader in(content);
    const auto channel = channels.topics.find(in.Take<std::uint16_t>());
    in.Take<std::uint32_t>();  // Sequence number.
    const auto time = in.Take<std::uint64_t>();
    in.Take<std::uint64_t>();  // Time of publication.
    if (!in.ok() || channel == channels.topics.end() ||
        time > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      return Fail(where, begin, "expected a message of a known channel, with its time");
    }
    return visit({&topics[channel->second], channel->second, static_cast<std::int64_t>(time),
                  content.substr(in.position())});
  }

  std::string_view bytes_;
  std::string file_;
  std::shared_ptr<const void> owner_;
};

}  // namespace

Expected<std::unique_ptr<Bag>> OpenMcap(std::string_view bytes, const std::string& file,
                                        std::shared_ptr<const void> owner) {
  auto bag = std::make_unique<Mcap>(bytes, file, std::move(owner));
  SEXTANT_RETURN_IF_ERROR(bag->Open());
  return std::unique_ptr<Bag>(std::move(bag));
}

}  // namespace sextant
