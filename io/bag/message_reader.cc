// SPDX-License-Identifier: Apache-2.0
#include "io/bag/message_reader.h"

#include <fmt/core.h>

#include "io/text/number_text.h"

namespace sextant {
namespace {

constexpr std::size_t kEncapsulation = 4;

// The second byte of the encapsulation: 0 big endian, 1 little endian, both without parameters.
bool IsBigEndianCdr(const BagMessage& message) {
  return message.topic->encoding == MessageEncoding::kCdr && message.data.size() > 1 &&
         message.data[1] == 0;
}

}  // namespace

MessageReader::MessageReader(const BagMessage& message)
    : message_(message),
      is_ros1_(message.topic->encoding == MessageEncoding::kRos1),
      bytes_(message.data, IsBigEndianCdr(message)) {
  if (is_ros1_) return;
  const std::string_view head = bytes_.Bytes(kEncapsulation);
  if (message.topic->encoding != MessageEncoding::kCdr || head.empty() || head[0] != 0 ||
      (head[1] != 0 && head[1] != 1)) {
    Fail(ErrorCode::kParse, "encapsulation", "expected plain CDR, as ROS 2 writes it");
  }
}

// CDR aligns a number to its size, counted from the end of the encapsulation.
void MessageReader::Align(std::size_t size) {
  if (is_ros1_ || error_) return;
  const std::size_t at = bytes_.position() - kEncapsulation;
  bytes_.Bytes((size - at % size) % size);
}

void MessageReader::CheckEnd(std::string_view field) {
  if (bytes_.ok()) return;
  Fail(ErrorCode::kParse, field,
       fmt::format("extends beyond the message, which has {} bytes", message_.data.size()));
}

std::string MessageReader::String(std::string_view field) {
  std::string_view text = ByteSequence(field);
  // CDR counts a terminating zero byte, and some writers of ROS 1 add one too.
  if (text.ends_with('\0')) text.remove_suffix(1);
  return std::string(text);
}

std::string_view MessageReader::ByteSequence(std::string_view field) {
  const std::string_view bytes = bytes_.Bytes(Take<std::uint32_t>(field));
  CheckEnd(field);
  return error_ ? std::string_view() : bytes;
}

std::size_t MessageReader::Length(std::size_t min_size, std::string_view field) {
  const std::size_t length = Take<std::uint32_t>(field);
  if (ok() && length > bytes_.bytes_left() / min_size) {
    Fail(ErrorCode::kParse, field,
         fmt::format("has {} entries, more than fit into {} bytes", length, bytes_.bytes_left()));
  }
  return ok() ? length : 0;
}

MessageHeader MessageReader::Header() {
  constexpr std::int64_t kSecond = 1'000'000'000;
  if (is_ros1_) Take<std::uint32_t>("header.seq");
  // Seconds are signed in ROS 2 only.
  std::int64_t seconds = Take<std::uint32_t>("header.stamp");
  if (!is_ros1_) seconds = static_cast<std::int32_t>(seconds);
  const std::int64_t nanoseconds = Take<std::uint32_t>("header.stamp");
  MessageHeader header;
  header.stamp_ns = seconds * kSecond + nanoseconds;
  header.frame = String("header.frame_id");
  return header;
}

void MessageReader::Fail(ErrorCode code, std::string_view field, std::string_view what) {
  if (error_) return;
  error_ = Error{code, fmt::format("{} at {}.{:09} s: {}: {}", Printable(message_.topic->name, 100),
                                   message_.time_ns / 1'000'000'000,
                                   message_.time_ns % 1'000'000'000, field, what)};
}

}  // namespace sextant
