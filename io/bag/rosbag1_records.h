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

/// The first line of a ROS 1 bag of version 2.0 (wiki.ros.org/Bags/Format/2.0).
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

/// Reads the records in a part of a bag one after the other.
class BagRecords {
 public:
  /// For error messages, `origin` is the position of `bytes` and `where` its name.
  BagRecords(std::string_view bytes, std::size_t origin, std::string where)
      : bytes_(bytes), origin_(origin), where_(std::move(where)) {}

  /// The next record; none at the end. Error: kParse, with the byte.
  Expected<std::optional<BagRecord>> Next();
  /// Whether Next() failed because the record extends beyond the bytes.
  bool is_cut() const { return is_cut_; }
  /// That record with as much of its data as there is; none if its header is not whole.
  std::optional<BagRecord> Begun() const;
  /// The position of the record that Next() returned last.
  std::size_t record_begin() const { return record_begin_; }

  /// The error "<where>: byte N: <what>" for the last record.
  tl::unexpected<Error> Fail(std::string_view what) const;

 private:
  std::string_view bytes_;
  std::size_t origin_;
  std::string where_;
  std::size_t position_ = 0;
  std::size_t record_begin_ = 0;
  bool is_cut_ = false;
};

/// The fields of a header, each <length><name>=<value>; none if it has another form.
std::optional<BagFields> ParseBagFields(std::string_view header);

/// The operation of a record; none if the field is missing.
std::optional<BagOp> OpOf(const BagFields& fields);

/// The value of a field that is a number of this type; none if there is no field of its size.
std::optional<std::uint32_t> Uint32Field(const BagFields& fields, std::string_view name);
std::optional<std::uint64_t> Uint64Field(const BagFields& fields, std::string_view name);
/// The value of a field that is a time in seconds and nanoseconds [ns].
std::optional<std::int64_t> TimeField(const BagFields& fields, std::string_view name);
/// The value of a field that is text; empty if there is none.
std::string TextField(const BagFields& fields, std::string_view name);

}  // namespace sextant
