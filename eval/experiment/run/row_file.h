// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "eval/experiment/definition/trials.h"
#include "io/output/appended_file.h"

namespace sextant {

/// A block of rows on disk. A row file consists of blocks of trials, written in order and each with
/// a mark and a checksum, so that a truncated file loses only its last block and a damaged one only
/// the blocks that are damaged. Little-endian:
///
///   "sxtrows1", u64 bytes, the configuration (JSON, padded with blanks to 8 bytes), u64 checksum
///   then blocks: u64 "sxtblock", u64 number, u64 rows, rows x u64 key, columns x rows x f64,
///   u64 checksum of all of the block before it
///
/// A key is (trial within the block) << 48 | subject << 32 | index. The number of a block
/// determines its trials, so files of several machines are merged by sorting their blocks (see
/// MergeRowFiles).
struct RowBlock {
  std::uint64_t number = 0;
  std::vector<std::uint64_t> keys;
  std::vector<double> columns;  ///< One column after another.

  /// The bytes of the block in a file.
  std::string Encode() const;
};

/// Makes a block of the rows with the wanted metrics; `first_trial` is the block's first trial.
RowBlock MakeRowBlock(std::uint64_t number, std::uint64_t first_trial, const TrialRows& rows);

inline std::uint64_t TrialOfKey(std::uint64_t key) { return key >> 48U; }
inline int SubjectOfKey(std::uint64_t key) { return static_cast<int>(key >> 32U & 0xffffU); }
inline int IndexOfKey(std::uint64_t key) { return static_cast<int>(key & 0xffffffffU); }

/// Position of an undamaged block in a file.
struct RowBlockPlace {
  std::uint64_t number = 0;
  std::uint64_t rows = 0;
  std::uint64_t offset = 0;
};

/// A part of a file that holds no undamaged block, with one after it.
struct RowFileDamage {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

/// Reads a row file. What is damaged is skipped up to the next undamaged block.
class RowFileReader {
 public:
  /// The number of columns is that of the configuration's metrics. Errors: kIo; kParse (not a row
  /// file, or its header is damaged). Time is at most that of reading the file ten times; memory is
  /// 24 bytes a block and its longest block.
  static Expected<RowFileReader> Open(const std::filesystem::path& path);
  ~RowFileReader();
  RowFileReader(RowFileReader&& other) noexcept;
  RowFileReader& operator=(RowFileReader&&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::string& configuration() const { return configuration_; }
  /// The undamaged blocks by ascending number, each number once.
  const std::vector<RowBlockPlace>& blocks() const { return blocks_; }
  std::size_t columns() const { return columns_; }
  /// Whether the file holds these blocks in this order and nothing else, but an unfinished end.
  bool is_orderly() const { return is_orderly_; }
  const std::vector<RowFileDamage>& damage() const { return damage_; }
  /// The end of the last undamaged block; a block that was not finished may follow.
  std::uint64_t whole_bytes() const { return whole_bytes_; }
  std::uint64_t file_bytes() const { return file_bytes_; }

  Expected<std::vector<std::uint64_t>> ReadKeys(const RowBlockPlace& block) const;
  Expected<std::vector<double>> ReadColumn(const RowBlockPlace& block, std::size_t column) const;
  /// The bytes of the block in the file.
  Expected<std::string> ReadBytes(const RowBlockPlace& block) const;

 private:
  RowFileReader() = default;
  Expected<void> ReadHeader();
  void FindBlocks();
  std::optional<RowBlockPlace> BlockAt(std::uint64_t offset, std::string& bytes) const;
  std::optional<std::uint64_t> NextMark(std::uint64_t offset, std::string& bytes) const;
  void SortBlocks();
  bool ReadAt(std::uint64_t offset, void* bytes, std::size_t size) const;

  std::filesystem::path path_;
  int fd_ = -1;
  std::string configuration_;
  std::size_t columns_ = 0;
  std::vector<RowBlockPlace> blocks_;
  std::vector<RowFileDamage> damage_;
  bool is_orderly_ = true;
  std::uint64_t whole_bytes_ = 0;
  std::uint64_t file_bytes_ = 0;
};

/// "rows.sxtrows: bytes 100 to 900 are damaged"; one line for each part.
std::vector<std::string> DescribeDamage(const RowFileReader& reader);

/// Writes a row file; only one process can write it at a time.
class RowFileWriter {
 public:
  /// Creates the file, or opens it to continue: an unfinished block at its end is cut off, and
  /// damage before it stays until OrderRowFile(). With `fresh`, existing rows are discarded, but no
  /// file of another kind. Errors: those of AppendedFile; kParse (not a row file); kInvalidInput
  /// (it holds the rows of another configuration).
  static Expected<RowFileWriter> Open(const std::filesystem::path& path,
                                      const std::string& configuration, bool fresh);

  /// Numbers of the undamaged blocks in the file when it was opened, ascending.
  const std::vector<std::uint64_t>& kept() const { return kept_; }
  /// What DescribeDamage said of the file when it was opened.
  const std::vector<std::string>& damage() const { return damage_; }
  /// Whether the blocks that were kept are in order and without damage between them.
  bool is_orderly() const { return is_orderly_; }

  /// Appends one block. After an error (such as a full disk) the file is unchanged.
  Expected<void> Append(std::string_view block) { return file_.Append(block); }
  /// Flushes all data to the disk.
  Expected<void> Flush() { return file_.Flush(); }

 private:
  explicit RowFileWriter(AppendedFile file) : file_(std::move(file)) {}
  Expected<void> Keep(const std::filesystem::path& path, const std::string& configuration);

  AppendedFile file_;
  std::vector<std::uint64_t> kept_;
  std::vector<std::string> damage_;
  bool is_orderly_ = true;
};

/// Rewrites the file with its undamaged blocks in ascending order and nothing else. Killed at any
/// time, it leaves the file as it was, or as it is to be. Errors: kIo; kParse.
Expected<void> OrderRowFile(const std::filesystem::path& path);

/// The header of a file with this configuration.
std::string RowFileHeader(const std::string& configuration);

}  // namespace sextant
