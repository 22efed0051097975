// SPDX-License-Identifier: Apache-2.0
#include "cli/recording_summary.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "base/text/path_text.h"
#include "eval/statistics/text_table.h"
#include "io/text/number_text.h"
#include "report/collect/utc_text.h"

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
  std::string text = fmt::format("{}: {}, {} topics, {} messages", PathText(path), bag.format(),
                                 bag.topics().size(), messages);
  if (messages > 0) {
    const std::chrono::sys_time<std::chrono::nanoseconds> start{std::chrono::nanoseconds(first)};
    text += fmt::format(", {} s from {}", Fixed(Seconds(last - first), 3),
                        UtcText(std::chrono::floor<std::chrono::seconds>(start)));
  }
  text += "\n";
  return bag.cut() ? text + "warning: " + DescribeCut(bag) + "\n" : text;
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
    return "No pairs: it takes a topic of scans (PointCloud2, Livox CustomMsg) and one of images "
           "(Image, "
           "CompressedImage)\n";
  }
  std::string text;
  for (const BagPairing& pairing : all.pairings) {
    text += PairingText(bag, all, pairing, tolerance_s);
  }
  if (all.more_pairings > 0) {
    text +=
        fmt::format("and {} more pairs of topics, which are not paired here\n", all.more_pairings);
  }
  return text;
}

}  // namespace

std::string DescribeRecording(const Bag& bag, const BagStreams& streams, const std::string& path,
                              double tolerance_s) {
  return fmt::format("{}\n{}\n{}", Summary(bag, path), TopicTable(bag),
                     PairingsText(bag, streams, tolerance_s));
}

}  // namespace sextant::cli
