// SPDX-License-Identifier: Apache-2.0
#include "io/bag/rosbag1_records.h"

#include <fmt/core.h>

#include "io/bag/byte_reader.h"

namespace sextant {
namespace {

template <class Number>
std::optional<Number> NumberField(const BagFields& fields, std::string_view name) {
  const auto found = fields.find(name);
  if (found == fields.end() || found->second.size() != sizeof(Number)) return std::nullopt;
  return ByteReader(found->second).Take<Number>();
}

}  // namespace

Expected<std::optional<BagRecord>> BagRecords::Next() {
  record_begin_ = origin_ + position_;
  ByteReader in(bytes_.substr(position_));
  if (in.bytes_left() == 0) return std::optional<BagRecord>();
  const std::string_view header = in.Counted<std::uint32_t>();
  const std::string_view data = in.Counted<std::uint32_t>();
  if (!in.ok()) {
    is_cut_ = true;
    return Fail(
        fmt::format("a record extends beyond the {} bytes that follow: the recording is cut "
                    "short or damaged (`rosbag reindex` may repair it)",
                    bytes_.size() - position_));
  }
  std::optional<BagFields> fields = ParseBagFields(header);
  if (!fields) return Fail("expected the header of a record");
  position_ += in.position();
  return std::optional<BagRecord>({std::move(*fields), data});
}

std::optional<BagRecord> BagRecords::Begun() const {
  ByteReader in(bytes_.substr(position_));
  const std::string_view header = in.Counted<std::uint32_t>();
  in.Take<std::uint32_t>();
  std::optional<BagFields> fields = ParseBagFields(header);
  if (!in.ok() || !fields) return std::nullopt;
  return BagRecord{std::move(*fields), in.Bytes(in.bytes_left())};
}

tl::unexpected<Error> BagRecords::Fail(std::string_view what) const {
  return MakeError(ErrorCode::kParse, fmt::format("{}: byte {}: {}", where_, record_begin_, what));
}

std::optional<BagFields> ParseBagFields(std::string_view header) {
  BagFields fields;
  ByteReader in(header);
  while (in.bytes_left() > 0) {
    const std::string_view field = in.Counted<std::uint32_t>();
    const std::size_t equals = field.find('=');
    if (!in.ok() || equals == std::string_view::npos) return std::nullopt;
    fields[field.substr(0, equals)] = field.substr(equals + 1);
  }
  return fields;
}

std::optional<BagOp> OpOf(const BagFields& fields) {
  const std::optional<std::uint8_t> op = NumberField<std::uint8_t>(fields, "op");
  if (!op) return std::nullopt;
  return static_cast<BagOp>(*op);
}

std::optional<std::uint32_t> Uint32Field(const BagFields& fields, std::string_view name) {
  return NumberField<std::uint32_t>(fields, name);
}

std::optional<std::uint64_t> Uint64Field(const BagFields& fields, std::string_view name) {
  return NumberField<std::uint64_t>(fields, name);
}

std::optional<std::int64_t> TimeField(const BagFields& fields, std::string_view name) {
  const std::optional<std::uint64_t> both = Uint64Field(fields, name);
  if (!both) return std::nullopt;
  const auto seconds = static_cast<std::int64_t>(*both & 0xffffffffU);
  const auto nanoseconds = static_cast<std::int64_t>(*both >> 32U);
  return seconds * 1'000'000'000 + nanoseconds;
}

std::string TextField(const BagFields& fields, std::string_view name) {
  const auto found = fields.find(name);
  return found == fields.end() ? std::string() : std::string(found->second);
}

}  // namespace sextant
