// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tags/aruco_dictionary.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <opencv2/core/persistence.hpp>
#include <string>

#include "base/call_files.h"

namespace sextant {
namespace {

struct DictionaryEntry {
  const char* name;
  int type;
  int border_cells = 1;
};

constexpr std::array kDictionaries = {
    DictionaryEntry{"aruco_original", cv::aruco::DICT_ARUCO_ORIGINAL},
    DictionaryEntry{"aruco_4x4_50", cv::aruco::DICT_4X4_50},
    DictionaryEntry{"aruco_4x4_100", cv::aruco::DICT_4X4_100},
    DictionaryEntry{"aruco_4x4_250", cv::aruco::DICT_4X4_250},
    DictionaryEntry{"aruco_4x4_1000", cv::aruco::DICT_4X4_1000},
    DictionaryEntry{"aruco_5x5_50", cv::aruco::DICT_5X5_50},
    DictionaryEntry{"aruco_5x5_100", cv::aruco::DICT_5X5_100},
    DictionaryEntry{"aruco_5x5_250", cv::aruco::DICT_5X5_250},
    DictionaryEntry{"aruco_5x5_1000", cv::aruco::DICT_5X5_1000},
    DictionaryEntry{"aruco_6x6_50", cv::aruco::DICT_6X6_50},
    DictionaryEntry{"aruco_6x6_100", cv::aruco::DICT_6X6_100},
    DictionaryEntry{"aruco_6x6_250", cv::aruco::DICT_6X6_250},
    DictionaryEntry{"aruco_6x6_1000", cv::aruco::DICT_6X6_1000},
    DictionaryEntry{"aruco_7x7_50", cv::aruco::DICT_7X7_50},
    DictionaryEntry{"aruco_7x7_100", cv::aruco::DICT_7X7_100},
    DictionaryEntry{"aruco_7x7_250", cv::aruco::DICT_7X7_250},
    DictionaryEntry{"aruco_7x7_1000", cv::aruco::DICT_7X7_1000},
    DictionaryEntry{"aruco_tag16h5", cv::aruco::DICT_APRILTAG_16h5},
    DictionaryEntry{"aruco_tag25h9", cv::aruco::DICT_APRILTAG_25h9},
    DictionaryEntry{"aruco_tag36h10", cv::aruco::DICT_APRILTAG_36h10},
    DictionaryEntry{"aruco_tag36h11", cv::aruco::DICT_APRILTAG_36h11},
    DictionaryEntry{"aruco_tag36h11_border2", cv::aruco::DICT_APRILTAG_36h11, 2},
};

// OpenCV's parser calls itself for each level and would exhaust the stack. A line without many of
// these characters adds few levels.
bool MayNestDeeply(const std::string& path) {
  constexpr int kMaxOpened = 64;
  std::ifstream file(path);
  int depth = 0;
  for (std::string line; std::getline(file, line);) {
    int dashes = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const bool closes_tag = line[i] == '<' && i + 1 < line.size() && line[i + 1] == '/';
      if (line[i] == '[' || line[i] == '{' || (line[i] == '<' && !closes_tag)) ++depth;
      if (line[i] == ']' || line[i] == '}' || closes_tag) --depth;
      if (line[i] == '-' && i + 1 < line.size() && line[i + 1] == ' ') ++dashes;
      if (depth > kMaxOpened || dashes > kMaxOpened) return true;
    }
  }
  return false;
}

}  // namespace

const std::vector<std::string>& ArucoDictionaryNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const DictionaryEntry& entry : kDictionaries) list.emplace_back(entry.name);
    return list;
  }();
  return names;
}

std::optional<cv::aruco::Dictionary> FindArucoDictionary(std::string_view name) {
  for (const DictionaryEntry& entry : kDictionaries) {
    if (name == entry.name) return PredefinedArucoDictionary(entry.type);
  }
  return std::nullopt;
}

int ArucoBorderCells(std::string_view name) {
  const auto* entry = std::ranges::find(kDictionaries, name, &DictionaryEntry::name);
  return entry == kDictionaries.end() ? 1 : entry->border_cells;
}

Expected<cv::aruco::Dictionary> ReadArucoDictionary(const std::string& path) {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t{16} << 20;
  cv::aruco::Dictionary dictionary;
  // Checked first because OpenCV prints a message of its own for a missing file.
  if (std::error_code error; !std::filesystem::is_regular_file(path, error)) {
    return MakeError(ErrorCode::kIo, fmt::format("{}: there is no dictionary file", path));
  }
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) {
    const std::string why = NoteInput(status);
    if (!why.empty()) return MakeError(ErrorCode::kInvalidOption, fmt::format("{}: {}", path, why));
  }
  std::error_code ignored;
  if (std::filesystem::file_size(path, ignored) > kMaxBytes || MayNestDeeply(path)) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: expected a dictionary of at most {} bytes, "
                                 "with short lines and few brackets",
                                 path, kMaxBytes));
  }
  try {
    const cv::FileStorage file(path, cv::FileStorage::READ);
    if (!file.isOpened()) {
      return MakeError(ErrorCode::kIo, fmt::format("{}: the dictionary cannot be opened", path));
    }
    // readDictionary does not check that the file has as many bits as it states.
    const int size = static_cast<int>(file["markersize"]);
    const int count = static_cast<int>(file["nmarkers"]);
    if (size < 3 || size > 16 || count < 1 || count > 65536) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("{}: expected nmarkers from 1 to 65536 and markersize from 3 to "
                                   "16, got {} and {}",
                                   path, count, size));
    }
    for (int id = 0; id < count; ++id) {
      const std::string bits = static_cast<std::string>(file[fmt::format("marker_{}", id)]);
      const auto bit_count = std::ranges::count(bits, '0') + std::ranges::count(bits, '1');
      if (bit_count != size * size || std::ssize(bits) != bit_count) {
        return MakeError(ErrorCode::kParse, fmt::format("{}: marker_{}: expected {} digits 0 or 1",
                                                        path, id, size * size));
      }
    }
    dictionary.readDictionary(file.root());
  } catch (const cv::Exception& error) {
    return MakeError(ErrorCode::kParse, fmt::format("{}: not a dictionary: {}", path, error.err));
  }
  return dictionary;
}

TagPattern MakeArucoPattern(const cv::aruco::Dictionary& dictionary, int id, int border_cells) {
  const int bits = dictionary.markerSize;
  const cv::Mat inner =
      cv::aruco::Dictionary::getBitsFromByteList(dictionary.bytesList.rowRange(id, id + 1), bits);
  const int cells = bits + 2 * border_cells;
  TagPattern pattern{.cells = cells, .edge_first = 0, .edge_cells = cells, .white = {}};
  pattern.white.assign(static_cast<std::size_t>(pattern.cells * pattern.cells), 0);
  for (int row = 0; row < bits; ++row) {
    for (int column = 0; column < bits; ++column) {
      const int cell = (row + border_cells) * cells + column + border_cells;
      pattern.white[static_cast<std::size_t>(cell)] = inner.at<std::uint8_t>(row, column);
    }
  }
  return pattern;
}

}  // namespace sextant
