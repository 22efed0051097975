// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"

namespace sextant {

/// The records that a ROS 1 bag of version 2.0 consists of (wiki.ros.org/Bags/Format/2.0).
inline constexpr std::string_view kRosbag1Magic = "#ROSBAG V2.0\n";

enum class BagOp : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndexData = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

/// The fields of a record's header, by name. Views into the file.
using BagFields = std::map<std::string_view, std::string_view>;

struct BagRecord {
  BagFields fields;
  std::string_view data;
};

/// Takes the records of a stretch of a bag one after the other.
class BagRecords {
 public:
  /// `origin` is where `bytes` begins, and `where` what it is, for messages.
  BagRecords(std::string_view bytes, std::size_t origin, std::string where)
      : bytes_(bytes), origin_(origin), where_(std::move(where)) {}

  /// The next record; none at the end. Error: kParse, with the byte.
  Expected<std::optional<BagRecord>> Next();
  /// Where the record that Next() gave last begins.
  std::size_t record_begin() const { return record_begin_; }

  /// "<where>: byte N: <what>", of the last record.
  tl::unexpected<Error> Fail(std::string_view what) const;

 private:
  std::string_view bytes_;
  std::size_t origin_;
  std::string where_;
  std::size_t position_ = 0;
  std::size_t record_begin_ = 0;
};

/// The fields of a header: <length><name>=<value> each. None where they are not.
std::optional<BagFields> ParseBagFields(std::string_view header);

/// The operation of a record; none where it states none.
std::optional<BagOp> OpOf(const BagFields& fields);

/// A field that is a number of this type; none where there is none of its size.
std::optional<std::uint32_t> Uint32Field(const BagFields& fields, std::string_view name);
std::optional<std::uint64_t> Uint64Field(const BagFields& fields, std::string_view name);
/// A field that is a time: seconds and nanoseconds [ns].
std::optional<std::int64_t> TimeField(const BagFields& fields, std::string_view name);
/// A field that is text; empty where there is none.
std::string TextField(const BagFields& fields, std::string_view name);

}  // namespace sextant
