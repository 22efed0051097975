// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "io/bag/bag.h"
#include "io/bag/byte_reader.h"
#include "io/bag/messages.h"

namespace sextant {

/// Reads the fields of a message of ROS 1 or ROS 2 (CDR, OMG formal/2002-06-51 chapter 15.3,
/// preceded by four bytes of encapsulation) and keeps the first error. After an error every result
/// is zero or empty.
class MessageReader {
 public:
  explicit MessageReader(const BagMessage& message);

  bool ok() const { return !error_; }
  tl::unexpected<Error> TakeError() { return tl::unexpected<Error>(*error_); }
  bool is_ros1() const { return is_ros1_; }

  template <class Number>
  Number Take(std::string_view field) {
    Align(sizeof(Number));
    const Number number = bytes_.Take<Number>();
    CheckEnd(field);
    return number;
  }

  std::string String(std::string_view field);
  /// A sequence of bytes: its length, then the bytes.
  std::string_view ByteSequence(std::string_view field);
  /// The length of a sequence whose entries take at least `min_size` bytes each.
  std::size_t Length(std::size_t min_size, std::string_view field);
  /// std_msgs/Header.
  MessageHeader Header();

  void Fail(ErrorCode code, std::string_view field, std::string_view what);

 private:
  void Align(std::size_t size);
  void CheckEnd(std::string_view field);

  const BagMessage& message_;
  bool is_ros1_;
  ByteReader bytes_;
  std::optional<Error> error_;
};

}  // namespace sextant
