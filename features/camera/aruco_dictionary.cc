// SPDX-License-Identifier: Apache-2.0
#include "features/camera/aruco_dictionary.h"

#include <array>

namespace sextant {
namespace {

struct Entry {
  const char* name;
  cv::aruco::PREDEFINED_DICTIONARY_NAME dictionary;
};

constexpr std::array kDictionaries = {
    Entry{"aruco_original", cv::aruco::DICT_ARUCO_ORIGINAL},
    Entry{"aruco_4x4_50", cv::aruco::DICT_4X4_50},
    Entry{"aruco_4x4_100", cv::aruco::DICT_4X4_100},
    Entry{"aruco_4x4_250", cv::aruco::DICT_4X4_250},
    Entry{"aruco_4x4_1000", cv::aruco::DICT_4X4_1000},
    Entry{"aruco_5x5_50", cv::aruco::DICT_5X5_50},
    Entry{"aruco_5x5_100", cv::aruco::DICT_5X5_100},
    Entry{"aruco_5x5_250", cv::aruco::DICT_5X5_250},
    Entry{"aruco_5x5_1000", cv::aruco::DICT_5X5_1000},
    Entry{"aruco_6x6_50", cv::aruco::DICT_6X6_50},
    Entry{"aruco_6x6_100", cv::aruco::DICT_6X6_100},
    Entry{"aruco_6x6_250", cv::aruco::DICT_6X6_250},
    Entry{"aruco_6x6_1000", cv::aruco::DICT_6X6_1000},
    Entry{"aruco_7x7_50", cv::aruco::DICT_7X7_50},
    Entry{"aruco_7x7_100", cv::aruco::DICT_7X7_100},
    Entry{"aruco_7x7_250", cv::aruco::DICT_7X7_250},
    Entry{"aruco_7x7_1000", cv::aruco::DICT_7X7_1000},
    Entry{"aruco_tag16h5", cv::aruco::DICT_APRILTAG_16h5},
    Entry{"aruco_tag25h9", cv::aruco::DICT_APRILTAG_25h9},
    Entry{"aruco_tag36h10", cv::aruco::DICT_APRILTAG_36h10},
    Entry{"aruco_tag36h11", cv::aruco::DICT_APRILTAG_36h11},
};

}  // namespace

const std::vector<std::string>& ArucoDictionaryNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Entry& entry : kDictionaries) list.emplace_back(entry.name);
    return list;
  }();
  return names;
}

std::optional<cv::Ptr<cv::aruco::Dictionary>> FindArucoDictionary(std::string_view name) {
  for (const Entry& entry : kDictionaries) {
    if (name == entry.name) return cv::aruco::getPredefinedDictionary(entry.dictionary);
  }
  return std::nullopt;
}

}  // namespace sextant
