// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
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
/// a checksum, so that a truncated file loses only its last block. Little-endian:
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

/// Reads a row file. Blocks after the first damaged one are ignored.
class RowFileReader {
 public:
  /// The number of columns is that of the configuration's metrics. Errors: kIo; kParse (not a row
  /// file, or its header is damaged).
  static Expected<RowFileReader> Open(const std::filesystem::path& path);
  ~RowFileReader();
  RowFileReader(RowFileReader&& other) noexcept;
  RowFileReader& operator=(RowFileReader&&) = delete;

  const std::string& configuration() const { return configuration_; }
  const std::vector<RowBlockPlace>& blocks() const { return blocks_; }
  std::size_t columns() const { return columns_; }
  /// Bytes of the header and all undamaged blocks; whatever follows is damaged.
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
  bool ReadAt(std::uint64_t offset, void* bytes, std::size_t size) const;

  std::filesystem::path path_;
  int fd_ = -1;
  std::string configuration_;
  std::size_t columns_ = 0;
  std::vector<RowBlockPlace> blocks_;
  std::uint64_t whole_bytes_ = 0;
  std::uint64_t file_bytes_ = 0;
};

/// Writes a row file; only one process can write it at a time.
class RowFileWriter {
 public:
  /// Creates the file, or opens it to continue: a damaged end is cut off. With `fresh`, existing
  /// rows are discarded, but no file of another kind. Errors: those of AppendedFile; kParse (not a
  /// row file); kInvalidInput (it holds the rows of another configuration).
  static Expected<RowFileWriter> Open(const std::filesystem::path& path,
                                      const std::string& configuration, bool fresh);

  /// Numbers of the blocks in the file when it was opened, in file order.
  const std::vector<std::uint64_t>& kept() const { return kept_; }

  /// Appends one block. After an error (such as a full disk) the file is unchanged.
  Expected<void> Append(std::string_view block) { return file_.Append(block); }
  /// Flushes all data to the disk.
  Expected<void> Flush() { return file_.Flush(); }

 private:
  explicit RowFileWriter(AppendedFile file) : file_(std::move(file)) {}
  Expected<void> Keep(const std::filesystem::path& path, const std::string& configuration);

  AppendedFile file_;
  std::vector<std::uint64_t> kept_;
};

/// The header of a file with this configuration.
std::string RowFileHeader(const std::string& configuration);

}  // namespace sextant
