// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "eval/experiment/definition/trials.h"

namespace sextant {

/// Rows on disk, in blocks of trials: written in order, each with its checksum, so that a file cut
/// anywhere loses its last block and no more. Little-endian:
///
///   "sxtrows1", u64 bytes, the configuration (JSON, padded with blanks to 8 bytes), u64 checksum
///   then blocks: u64 "sxtblock", u64 number, u64 rows, rows x u64 key, columns x rows x f64,
///   u64 checksum of all of the block before it
///
/// A key is trial within the block << 48 | subject << 32 | index. The number of a block says which
/// trials it holds, so files of several machines merge by sorting blocks (see MergeRowFiles).
struct RowBlock {
  std::uint64_t number = 0;
  std::vector<std::uint64_t> keys;
  std::vector<double> columns;  ///< Column after column.

  /// The bytes of the block as the file holds them.
  std::string Encode() const;
};

/// The block of these rows with the wanted metrics; their trials count from `first_trial`.
RowBlock MakeRowBlock(std::uint64_t number, std::uint64_t first_trial, const TrialRows& rows);

inline std::uint64_t TrialOfKey(std::uint64_t key) { return key >> 48U; }
inline int SubjectOfKey(std::uint64_t key) { return static_cast<int>(key >> 32U & 0xffffU); }
inline int IndexOfKey(std::uint64_t key) { return static_cast<int>(key & 0xffffffffU); }

/// Where a whole block stands in a file.
struct RowBlockPlace {
  std::uint64_t number = 0;
  std::uint64_t rows = 0;
  std::uint64_t offset = 0;
};

/// A row file that is read. Blocks after the first damaged one do not count.
class RowFileReader {
 public:
  /// `columns` of a block are as many as the configuration has metrics. Errors: kIo; kParse (no row
  /// file, or its beginning is damaged).
  static Expected<RowFileReader> Open(const std::filesystem::path& path);
  ~RowFileReader();
  RowFileReader(RowFileReader&& other) noexcept;
  RowFileReader& operator=(RowFileReader&&) = delete;

  const std::string& configuration() const { return configuration_; }
  const std::vector<RowBlockPlace>& blocks() const { return blocks_; }
  std::size_t columns() const { return columns_; }
  /// How many bytes the header and the whole blocks take; what follows is damaged.
  std::uint64_t whole_bytes() const { return whole_bytes_; }
  std::uint64_t file_bytes() const { return file_bytes_; }

  Expected<std::vector<std::uint64_t>> ReadKeys(const RowBlockPlace& block) const;
  Expected<std::vector<double>> ReadColumn(const RowBlockPlace& block, std::size_t column) const;
  /// The block as it stands in the file.
  Expected<std::string> ReadBytes(const RowBlockPlace& block) const;

 private:
  RowFileReader() = default;
  Expected<void> ReadHeader();
  void FindBlocks();
  bool ReadAt(std::uint64_t offset, void* bytes, std::size_t size) const;

  std::filesystem::path path_;
  int fd_ = -1;
  std::string configuration_;
  std::size_t columns_ = 0;
  std::vector<RowBlockPlace> blocks_;
  std::uint64_t whole_bytes_ = 0;
  std::uint64_t file_bytes_ = 0;
};

/// A row file that is written, by one process at a time.
class RowFileWriter {
 public:
  /// Creates the file, or opens it to go on: what is damaged at its end is cut off. `columns` is
  /// the number of metrics. Errors: kIo (no permission, no space, another process writes it);
  /// kInvalidInput (it holds the rows of another configuration).
  static Expected<RowFileWriter> Open(const std::filesystem::path& path,
                                      const std::string& configuration, bool fresh);
  ~RowFileWriter();
  RowFileWriter(RowFileWriter&& other) noexcept;
  RowFileWriter& operator=(RowFileWriter&&) = delete;

  /// Numbers of the blocks that the file had when it was opened, in its order.
  const std::vector<std::uint64_t>& kept() const { return kept_; }

  /// Appends one block. After an error (disk full) the file is as it was before the call.
  Expected<void> Append(std::string_view block);
  /// Everything is on the disk when this returns.
  Expected<void> Flush();

 private:
  RowFileWriter() = default;
  Expected<void> Lock();
  Expected<void> Keep(const std::string& configuration);

  std::filesystem::path path_;
  int fd_ = -1;
  std::uint64_t bytes_ = 0;
  std::vector<std::uint64_t> kept_;
};

/// The bytes with which a file of this configuration begins.
std::string RowFileHeader(const std::string& configuration);

}  // namespace sextant
