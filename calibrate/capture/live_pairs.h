// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "calibrate/session/file_pairs.h"

namespace sextant {

/// The time in a file name without its extension [ns since 1970]: its last number is 19, 16, 13 or
/// 10 digits of nano-, micro-, milliseconds or seconds, or 10 digits of seconds and, after a `.` or
/// `_`, 3, 6 or 9 of their fraction. None for years before 1998 and after 2099.
std::optional<std::int64_t> StampInName(std::string_view stem);

/// Pairs of the files that are there so far, of which more may follow:
/// - by time, within the tolerance, where every name states one (StampInName);
/// - else by the last numbers of the names, as many as every name has, where these differ among the
///   photos and among the scans: 7 of photo_7 and scan_007;
/// - else, from two photos and two scans on, as PairFiles does.
/// A single photo and a single scan are a pair only if their numbers or times agree, as the partner
/// of either may be still to come. More files can change the pairs of the last kind.
FilePairs PairSoFar(const std::vector<std::filesystem::path>& images,
                    const std::vector<std::filesystem::path>& clouds, double tolerance_s);

}  // namespace sextant
