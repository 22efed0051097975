// SPDX-License-Identifier: Apache-2.0
#include "calibrate/capture/live_pairs.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string>

#include "base/pair_by_stamp.h"
#include "base/text/printable.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;
using Paths = std::vector<fs::path>;

bool IsDigitOfName(char c) { return c >= '0' && c <= '9'; }

// The runs of digits of a text, in their order.
std::vector<std::string_view> NumbersIn(std::string_view text) {
  std::vector<std::string_view> numbers;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    while (end < text.size() && IsDigitOfName(text[end])) ++end;
    if (end > i) numbers.push_back(text.substr(i, end - i));
    i = end + 1;
  }
  return numbers;
}

std::optional<std::int64_t> ValueOf(std::string_view digits) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

std::int64_t PowerOfTen(std::size_t exponent) {
  std::int64_t power = 1;
  for (std::size_t i = 0; i < exponent; ++i) power *= 10;
  return power;
}

// A time, given the digits of its seconds and all that follow; none if it is no plausible one.
std::optional<std::int64_t> StampOfDigits(std::string_view seconds, std::string_view fraction) {
  constexpr std::int64_t kEarliest_s = 883'612'800;  // 1998.
  constexpr std::int64_t kLatest_s = 4'102'444'800;  // 2100.
  constexpr std::size_t kDigitsOfNanoseconds = 9;
  const auto whole = ValueOf(seconds);
  if (!whole || *whole < kEarliest_s || *whole >= kLatest_s) return std::nullopt;
  std::int64_t ns = *whole * PowerOfTen(kDigitsOfNanoseconds);
  if (fraction.empty()) return ns;
  const auto part = ValueOf(fraction);
  if (!part) return std::nullopt;
  return ns + *part * PowerOfTen(kDigitsOfNanoseconds - fraction.size());
}

std::optional<std::vector<std::int64_t>> StampsOf(const Paths& files) {
  std::vector<std::int64_t> stamps;
  for (const fs::path& file : files) {
    const auto stamp = StampInName(file.stem().string());
    if (!stamp) return std::nullopt;
    stamps.push_back(*stamp);
  }
  return stamps;
}

FilePairs PairByTime(const Paths& images, const std::vector<std::int64_t>& image_ns,
                     const Paths& clouds, const std::vector<std::int64_t>& cloud_ns,
                     double tolerance_s) {
  const auto tolerance_ns = static_cast<std::int64_t>(std::llround(1e9 * tolerance_s));
  const StampPairs found = PairByStamp(image_ns, cloud_ns, tolerance_ns);
  FilePairs result;
  for (const StampPair& pair : found.pairs) {
    const fs::path& image = images[pair.first];
    result.pairs.push_back({PrintableLine(image.stem().string()), image, clouds[pair.second]});
  }
  for (const std::size_t i : found.unpaired_first) result.without_partner.push_back(images[i]);
  for (const std::size_t i : found.unpaired_second) result.without_partner.push_back(clouds[i]);
  return result;
}

using NumberKey = std::vector<std::int64_t>;

// The last `count` numbers of each name; empty where two names have the same ones.
std::map<NumberKey, fs::path> ByNumbers(const Paths& files, std::size_t count) {
  std::map<NumberKey, fs::path> by_key;
  for (const fs::path& file : files) {
    const std::string stem = file.stem().string();
    const std::vector<std::string_view> numbers = NumbersIn(stem);
    NumberKey key;
    for (std::size_t i = numbers.size() - count; i < numbers.size(); ++i) {
      key.push_back(ValueOf(numbers[i]).value_or(-1));
    }
    if (!by_key.emplace(key, file).second) return {};
  }
  return by_key;
}

std::size_t FewestNumbers(const Paths& images, const Paths& clouds) {
  std::size_t fewest = std::string::npos;
  for (const Paths* files : {&images, &clouds}) {
    for (const fs::path& file : *files) {
      fewest = std::min(fewest, NumbersIn(file.stem().string()).size());
    }
  }
  return fewest;
}

// The last `count` numbers of a name with what is between them: "7" of photo_7.
std::string NumberedName(const fs::path& file, std::size_t count) {
  const std::string stem = file.stem().string();
  const std::vector<std::string_view> numbers = NumbersIn(stem);
  const char* begin = numbers[numbers.size() - count].data();
  return PrintableLine(std::string(begin, numbers.back().data() + numbers.back().size()));
}

// None where the numbers do not identify the files, or no two of them agree.
std::optional<FilePairs> PairByNumbers(const Paths& images, const Paths& clouds) {
  const std::size_t count = FewestNumbers(images, clouds);
  if (count == 0) return std::nullopt;
  const auto image_by_key = ByNumbers(images, count);
  auto cloud_by_key = ByNumbers(clouds, count);
  if (image_by_key.empty() || cloud_by_key.empty()) return std::nullopt;
  FilePairs result;
  for (const auto& [key, image] : image_by_key) {
    const auto cloud = cloud_by_key.find(key);
    if (cloud == cloud_by_key.end()) {
      result.without_partner.push_back(image);
      continue;
    }
    result.pairs.push_back({NumberedName(image, count), image, cloud->second});
    cloud_by_key.erase(cloud);
  }
  for (const auto& [key, cloud] : cloud_by_key) result.without_partner.push_back(cloud);
  if (result.pairs.empty()) return std::nullopt;
  return result;
}

}  // namespace

std::optional<std::int64_t> StampInName(std::string_view stem) {
  constexpr std::size_t kDigitsOfSeconds = 10;
  const std::vector<std::string_view> numbers = NumbersIn(stem);
  if (numbers.empty()) return std::nullopt;
  const std::string_view last = numbers.back();
  const auto is_fraction = [](std::size_t digits) {
    return digits == 3 || digits == 6 || digits == 9;
  };
  if (last.size() == kDigitsOfSeconds) return StampOfDigits(last, {});
  if (last.size() > kDigitsOfSeconds && is_fraction(last.size() - kDigitsOfSeconds)) {
    return StampOfDigits(last.substr(0, kDigitsOfSeconds), last.substr(kDigitsOfSeconds));
  }
  if (numbers.size() < 2 || !is_fraction(last.size())) return std::nullopt;
  const std::string_view seconds = numbers[numbers.size() - 2];
  const char* separator = seconds.data() + seconds.size();
  const bool is_joined = separator + 1 == last.data() && (*separator == '.' || *separator == '_');
  if (!is_joined || seconds.size() != kDigitsOfSeconds) return std::nullopt;
  return StampOfDigits(seconds, last);
}

FilePairs PairSoFar(const Paths& images, const Paths& clouds, double tolerance_s) {
  if (!images.empty() && !clouds.empty()) {
    const auto image_ns = StampsOf(images);
    const auto cloud_ns = StampsOf(clouds);
    if (image_ns && cloud_ns) return PairByTime(images, *image_ns, clouds, *cloud_ns, tolerance_s);
    if (auto by_numbers = PairByNumbers(images, clouds)) return *std::move(by_numbers);
    if (images.size() > 1 && clouds.size() > 1) return PairFiles(images, clouds);
  }
  FilePairs none{.without_partner = images};
  none.without_partner.insert(none.without_partner.end(), clouds.begin(), clouds.end());
  return none;
}

}  // namespace sextant
