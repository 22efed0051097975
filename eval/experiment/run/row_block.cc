// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cassert>

#include "eval/experiment/run/row_checksum.h"
#include "eval/experiment/run/row_file.h"

namespace sextant {
namespace {

static_assert(std::endian::native == std::endian::little, "row files are little-endian");

void AppendWord(std::uint64_t word, std::string& bytes) {
  char text[8];
  std::memcpy(text, &word, 8);
  bytes.append(text, 8);
}

template <class Word>
void AppendWords(const std::vector<Word>& words, std::string& bytes) {
  const std::size_t begin = bytes.size();
  bytes.resize(begin + 8 * words.size());
  if (!words.empty()) std::memcpy(bytes.data() + begin, words.data(), 8 * words.size());
}

}  // namespace

std::string RowBlock::Encode() const {
  const std::size_t width = keys.empty() ? 0 : columns.size() / keys.size();
  std::string bytes;
  bytes.reserve(BytesOfBlock(keys.size(), width));
  bytes.append(kRowBlockMark);
  AppendWord(number, bytes);
  AppendWord(keys.size(), bytes);
  AppendWords(keys, bytes);
  AppendWords(columns, bytes);
  AppendWord(RowChecksum(bytes), bytes);
  return bytes;
}

RowBlock MakeRowBlock(std::uint64_t number, std::uint64_t first_trial, const TrialRows& rows) {
  RowBlock block{.number = number, .keys = {}, .columns = {}};
  block.keys.reserve(rows.keys().size());
  for (const TrialRows::Key& key : rows.keys()) {
    const std::uint64_t trial = key.trial - first_trial;
    assert(trial < 0x10000);
    block.keys.push_back(trial << 48U | std::uint64_t{key.subject} << 32U | key.index);
  }
  for (std::size_t metric = 0; metric < rows.metrics(); ++metric) {
    if (!rows.Wants(static_cast<int>(metric))) continue;
    for (std::size_t row = 0; row < block.keys.size(); ++row) {
      block.columns.push_back(rows.values()[row * rows.metrics() + metric]);
    }
  }
  return block;
}

std::string RowFileHeader(const std::string& configuration) {
  std::string padded = configuration;
  padded.append((8 - padded.size() % 8) % 8, ' ');
  std::string bytes(kRowFileMark);
  AppendWord(padded.size(), bytes);
  bytes += padded;
  AppendWord(RowChecksum(bytes), bytes);
  return bytes;
}

}  // namespace sextant
