// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "base/call_files.h"
#include "base/text/path_text.h"
#include "eval/experiment/run/configuration.h"
#include "eval/experiment/run/row_checksum.h"
#include "eval/experiment/run/row_file.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

constexpr std::uint64_t kMaxHeader = std::uint64_t{64} << 20U;

tl::unexpected<Error> Unreadable(const std::filesystem::path& path) {
  return MakeError(
      ErrorCode::kIo,
      fmt::format("cannot read '{}': {}", PathText(path),
                  errno == 0 ? "it ends too early" : std::generic_category().message(errno)));
}

tl::unexpected<Error> Damaged(const std::filesystem::path& path) {
  return MakeError(
      ErrorCode::kParse,
      fmt::format("{}: not a row file of an experiment, or its header is damaged; check the path",
                  PathText(path)));
}

}  // namespace

RowFileReader::~RowFileReader() {
  if (fd_ >= 0) close(fd_);
}

RowFileReader::RowFileReader(RowFileReader&& other) noexcept
    : path_(std::move(other.path_)),
      fd_(std::exchange(other.fd_, -1)),
      configuration_(std::move(other.configuration_)),
      columns_(other.columns_),
      blocks_(std::move(other.blocks_)),
      damage_(std::move(other.damage_)),
      is_orderly_(other.is_orderly_),
      whole_bytes_(other.whole_bytes_),
      file_bytes_(other.file_bytes_) {}

bool RowFileReader::ReadAt(std::uint64_t offset, void* bytes, std::size_t size) const {
  char* to = static_cast<char*>(bytes);
  while (size > 0) {
    errno = 0;
    const ssize_t got = pread(fd_, to, size, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    to += got;
    offset += static_cast<std::uint64_t>(got);
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

Expected<RowFileReader> RowFileReader::Open(const std::filesystem::path& path) {
  RowFileReader reader;
  reader.path_ = path;
  reader.fd_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status {};
  if (reader.fd_ < 0 || fstat(reader.fd_, &status) != 0) return Unreadable(path);
  if (!S_ISREG(status.st_mode)) return Damaged(path);
  if (const std::string why = NoteInput(status); !why.empty()) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("cannot read '{}': {}", PathText(path), why));
  }
  reader.file_bytes_ = static_cast<std::uint64_t>(status.st_size);
  SEXTANT_RETURN_IF_ERROR(reader.ReadHeader());
  reader.FindBlocks();
  return reader;
}

Expected<void> RowFileReader::ReadHeader() {
  std::string head(16, '\0');
  if (file_bytes_ < head.size() || !ReadAt(0, head.data(), head.size())) return Damaged(path_);
  std::uint64_t size = 0;
  std::memcpy(&size, head.data() + 8, 8);
  if (!head.starts_with(kRowFileMark) || size > kMaxHeader || size % 8 != 0 ||
      file_bytes_ < head.size() + size + 8) {
    return Damaged(path_);
  }
  configuration_.resize(size);
  if (!ReadAt(16, configuration_.data(), size)) return Unreadable(path_);
  std::uint64_t checksum = 0;
  if (!ReadAt(16 + size, &checksum, 8)) return Unreadable(path_);
  if (checksum != RowChecksum(head + configuration_)) return Damaged(path_);
  configuration_.erase(configuration_.find_last_not_of(' ') + 1);
  columns_ = CountMetrics(configuration_);
  if (columns_ == 0 || columns_ > kMaxMetrics) return Damaged(path_);
  whole_bytes_ = 16 + size + 8;
  return {};
}

void RowFileReader::FindBlocks() {
  constexpr std::uint64_t kMaxReads = 8;
  std::string bytes;
  std::uint64_t offset = whole_bytes_;
  std::uint64_t in_vain = 0;
  while (true) {
    const std::optional<RowBlockPlace> block = BlockAt(offset, bytes);
    if (!block) {
      // Marks that a hostile file repeats could each claim the rest of the file.
      in_vain += bytes.size();
      if (in_vain > kMaxReads * file_bytes_) break;
      const std::optional<std::uint64_t> mark = NextMark(offset + 1, bytes);
      if (!mark) break;
      offset = *mark;
      continue;
    }
    if (offset > whole_bytes_) damage_.push_back({whole_bytes_, offset - whole_bytes_});
    blocks_.push_back(*block);
    offset += BytesOfBlock(block->rows, columns_);
    whole_bytes_ = offset;
  }
  SortBlocks();
}

std::optional<RowBlockPlace> RowFileReader::BlockAt(std::uint64_t offset,
                                                    std::string& bytes) const {
  std::uint64_t head[3];
  bytes.clear();
  if (offset + kRowBlockHead + 8 > file_bytes_ || !ReadAt(offset, head, sizeof head)) return {};
  const std::string_view mark(reinterpret_cast<const char*>(head), 8);
  const std::uint64_t left = file_bytes_ - offset;
  if (mark != kRowBlockMark || head[2] > left / 8 || BytesOfBlock(head[2], columns_) > left) {
    return {};
  }
  bytes.resize(BytesOfBlock(head[2], columns_));
  if (!ReadAt(offset, bytes.data(), bytes.size())) return {};
  std::uint64_t checksum = 0;
  std::memcpy(&checksum, bytes.data() + bytes.size() - 8, 8);
  if (checksum != RowChecksum(std::string_view{bytes}.substr(0, bytes.size() - 8))) return {};
  return RowBlockPlace{.number = head[1], .rows = head[2], .offset = offset};
}

// The next mark of a block; the length of a damaged block may be damaged too.
std::optional<std::uint64_t> RowFileReader::NextMark(std::uint64_t offset,
                                                     std::string& bytes) const {
  constexpr std::uint64_t kStep = std::uint64_t{1} << 16U;
  const std::uint64_t overlap = kRowBlockMark.size() - 1;
  for (; offset < file_bytes_; offset += kStep) {
    bytes.resize(std::min(kStep + overlap, file_bytes_ - offset));
    if (!ReadAt(offset, bytes.data(), bytes.size())) return {};
    const std::size_t found = bytes.find(kRowBlockMark);
    if (found != std::string::npos) return offset + found;
  }
  return {};
}

void RowFileReader::SortBlocks() {
  const auto less = [](const RowBlockPlace& a, const RowBlockPlace& b) {
    return a.number < b.number;
  };
  const auto same = [](const RowBlockPlace& a, const RowBlockPlace& b) {
    return a.number == b.number;
  };
  is_orderly_ = damage_.empty() && std::is_sorted(blocks_.begin(), blocks_.end(), less) &&
                std::adjacent_find(blocks_.begin(), blocks_.end(), same) == blocks_.end();
  if (is_orderly_) return;
  std::stable_sort(blocks_.begin(), blocks_.end(), less);
  blocks_.erase(std::unique(blocks_.begin(), blocks_.end(), same), blocks_.end());
}

std::vector<std::string> DescribeDamage(const RowFileReader& reader) {
  std::vector<std::string> lines;
  for (const RowFileDamage& damage : reader.damage()) {
    lines.push_back(fmt::format("{}: bytes {} to {} are damaged", PathText(reader.path()),
                                damage.offset, damage.offset + damage.bytes));
  }
  return lines;
}

Expected<std::vector<std::uint64_t>> RowFileReader::ReadKeys(const RowBlockPlace& block) const {
  std::vector<std::uint64_t> keys(block.rows);
  if (!ReadAt(block.offset + kRowBlockHead, keys.data(), 8 * keys.size())) return Unreadable(path_);
  return keys;
}

Expected<std::vector<double>> RowFileReader::ReadColumn(const RowBlockPlace& block,
                                                        std::size_t column) const {
  std::vector<double> values(block.rows);
  const std::uint64_t offset = block.offset + kRowBlockHead + 8 * block.rows * (1 + column);
  if (!ReadAt(offset, values.data(), 8 * values.size())) return Unreadable(path_);
  return values;
}

Expected<std::string> RowFileReader::ReadBytes(const RowBlockPlace& block) const {
  std::string bytes(BytesOfBlock(block.rows, columns_), '\0');
  if (!ReadAt(block.offset, bytes.data(), bytes.size())) return Unreadable(path_);
  return bytes;
}

}  // namespace sextant
