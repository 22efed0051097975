// SPDX-License-Identifier: Apache-2.0
#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>

#include "cli/bag_extract.h"
#include "cli/commands.h"
#include "cli/load.h"
#include "eval/statistics/text_table.h"
#include "io/text/number_text.h"

namespace sextant::cli {
namespace {

double Seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

std::string Summary(const Bag& bag, const std::string& path) {
  std::size_t messages = 0;
  std::int64_t first = 0;
  std::int64_t last = 0;
  for (const BagTopic& topic : bag.topics()) {
    if (topic.count == 0) continue;
    first = messages == 0 ? topic.first_ns : std::min(first, topic.first_ns);
    last = messages == 0 ? topic.last_ns : std::max(last, topic.last_ns);
    messages += topic.count;
  }
  std::string text = fmt::format("{}: {}, {} topics, {} messages", Printable(path, 200),
                                 bag.format(), bag.topics().size(), messages);
  if (messages > 0) {
    text += fmt::format(", {} s from {:%Y-%m-%d %H:%M:%S} UTC", Fixed(Seconds(last - first), 3),
                        fmt::gmtime(static_cast<std::time_t>(first / 1'000'000'000)));
  }
  return text + "\n";
}

std::string TopicTable(const Bag& bag) {
  TextTable table({"topic", "type", "messages", "span [s]", "rate [Hz]"});
  for (const BagTopic& topic : bag.topics()) {
    const double span = Seconds(topic.last_ns - topic.first_ns);
    const double steps = static_cast<double>(topic.count) - 1.0;
    table.AddRow({Printable(topic.name, 60), Printable(topic.type, 50), std::to_string(topic.count),
                  Fixed(span, 3), span > 0.0 && steps > 0.0 ? Fixed(steps / span, 1) : "-"});
  }
  return table.Plain();
}

std::string PairingText(const Bag& bag, const BagStreams& all, const BagPairing& pairing,
                        double tolerance_s) {
  const StampPairs& found = pairing.pairs;
  std::string text =
      fmt::format("{} with {}, within {} s: {} pairs",
                  Printable(bag.topics()[all.streams[pairing.scans].topic].name, 60),
                  Printable(bag.topics()[all.streams[pairing.images].topic].name, 60), tolerance_s,
                  found.pairs.size());
  if (!found.pairs.empty()) {
    std::vector<std::int64_t> distances;
    for (const StampPair& pair : found.pairs) distances.push_back(std::abs(pair.difference_ns));
    std::sort(distances.begin(), distances.end());
    text += fmt::format(" (apart: median {} ms, at most {} ms)",
                        Fixed(1e3 * Seconds(distances[distances.size() / 2]), 3),
                        Fixed(1e3 * Seconds(distances.back()), 3));
  }
  return text + fmt::format("; without a partner: {} scans, {} images\n",
                            found.unpaired_first.size(), found.unpaired_second.size());
}

std::string PairingsText(const Bag& bag, const BagStreams& all, double tolerance_s) {
  if (all.pairings.empty()) {
    return "No pairs: it takes a topic of scans (PointCloud2) and one of images (Image, "
           "CompressedImage)\n";
  }
  std::string text;
  for (const BagPairing& pairing : all.pairings) {
    text += PairingText(bag, all, pairing, tolerance_s);
  }
  return text;
}

}  // namespace

int RunBag(const BagOptions& options) {
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(options.path);
  if (!bag) return Refuse("bag", bag.error());
  const auto tolerance_ns = static_cast<std::int64_t>(1e9 * options.tolerance_s);
  const Expected<BagStreams> streams = ReadStreams(**bag, tolerance_ns);
  if (!streams) return Refuse("bag", streams.error());
  fmt::print("{}\n{}\n{}", Summary(**bag, options.path), TopicTable(**bag),
             PairingsText(**bag, *streams, options.tolerance_s));
  if (options.extract_folder.empty()) return kAnswered;
  const Expected<int> files = ExtractBag(**bag, *streams, options.extract_folder);
  if (!files) {
    const bool is_empty = files.error().code == ErrorCode::kMissingData;
    return Refuse("bag", files.error(), is_empty ? kNoAnswer : kWrongUse);
  }
  fmt::print("{}: {} files\n", Printable(options.extract_folder, 200), *files);
  return kAnswered;
}

}  // namespace sextant::cli
