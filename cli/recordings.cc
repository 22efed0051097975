// SPDX-License-Identifier: Apache-2.0
#include "cli/recordings.h"

#include <fmt/core.h>

#include <filesystem>
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "calibrate/bag/bag_image.h"
#include "calibrate/bag/bag_streams.h"
#include "cli/recording_summary.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/pcd_file.h"
#include "io/output/output_file.h"
#include "io/output/output_folder.h"

namespace sextant::cli {
namespace {

// The file that a message becomes; none for a camera that is the same as the one before.
struct Extracted {
  std::string extension;
  std::string bytes;
};

// "<number>_<stamp>", unique within its topic and in order.
std::string MessageName(std::size_t number, std::int64_t stamp_ns) {
  return fmt::format("{:06}_{}", number, stamp_ns);
}

// The topic as the name of a folder: "/camera/image_raw" is "camera_image_raw".
std::string FolderName(const std::string& topic) {
  std::string name;
  for (const char c : topic) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (plain || c == '-') {
      name += c;
    } else if (!name.empty() && name.size() < 200) {
      name += '_';
    }
  }
  return name.empty() ? "topic" : name.substr(0, 200);
}

class Extractor {
 public:
  Extractor(const Bag& bag, std::string folder) : bag_(bag), folder_(std::move(folder)) {}

  Expected<void> Take(const BagMessage& message) {
    SEXTANT_ASSIGN_OR_RETURN(const MessageHeader header, DecodeHeader(message));
    const std::size_t number = numbers_[message.topic_index]++;
    const std::string name = MessageName(number, header.stamp_ns);
    SEXTANT_ASSIGN_OR_RETURN(const std::optional<Extracted> file, Convert(message));
    if (!file) return {};
    const std::filesystem::path folder = FolderOf(message.topic_index);
    // Not for every message: it looks at all files of the folder.
    if (made_.insert(message.topic_index).second) SEXTANT_RETURN_IF_ERROR(MakeSubfolder(folder));
    ++files_;
    extensions_[{message.topic_index, number}] = file->extension;
    return WriteFileAtomically(folder / (name + file->extension), file->bytes);
  }

  // Two topics whose names give the same folder get different ones.
  std::filesystem::path FolderOf(std::size_t topic) {
    const auto known = folders_.find(topic);
    if (known != folders_.end()) return folder_ / std::filesystem::path(known->second);
    const std::string plain = FolderName(bag_.topics()[topic].name);
    std::string name = plain;
    std::size_t& number = numbers_of_name_[plain];
    while (!taken_.insert(name).second) name = fmt::format("{}_{}", plain, ++number + 1);
    folders_[topic] = name;
    return folder_ / std::filesystem::path(name);
  }

  std::string FileName(std::size_t topic, std::size_t number, std::int64_t stamp_ns) {
    return fmt::format("{}/{}{}", FolderOf(topic).filename().string(),
                       MessageName(number, stamp_ns), extensions_[{topic, number}]);
  }
  int files() const { return files_; }

 private:
  Expected<std::optional<Extracted>> Convert(const BagMessage& message) {
    switch (message.topic->kind) {
      case MessageKind::kPointCloud:
        return DecodePointCloud(message).map([](const CloudMessage& scan) {
          return std::optional<Extracted>({".pcd", FormatPcd(scan.cloud)});
        });
      case MessageKind::kEncodedImage:
        return DecodeEncodedImage(message).map([](const EncodedImageMessage& image) {
          return std::optional<Extracted>({"." + ExtensionOf(image), image.data});
        });
      case MessageKind::kImage:
        return DecodeImage(message).and_then(EncodePng).map([](std::string png) {
          return std::optional<Extracted>({".png", std::move(png)});
        });
      case MessageKind::kCameraInfo:
        return DecodeCameraInfo(message).map([&](const CameraInfoMessage& info) {
          std::string text = FormatCameraInfo(info.camera, info.header.frame);
          std::string& before = cameras_[message.topic_index];
          if (text == before) return std::optional<Extracted>();
          before = text;
          return std::optional<Extracted>({".yaml", std::move(text)});
        });
      case MessageKind::kOther:
        break;
    }
    return std::optional<Extracted>();
  }

  const Bag& bag_;
  std::filesystem::path folder_;
  std::map<std::size_t, std::size_t> numbers_;  // The next message's, by topic.
  std::map<std::size_t, std::string> folders_;
  std::unordered_set<std::string> taken_;
  std::unordered_set<std::size_t> made_;                          // Topics whose folder is there.
  std::unordered_map<std::string, std::size_t> numbers_of_name_;  // The last number of each name.
  // By topic and number of the message: a topic may have images of several formats.
  std::map<std::pair<std::size_t, std::size_t>, std::string> extensions_;
  std::map<std::size_t, std::string> cameras_;
  int files_ = 0;
};

std::string PairsText(const BagStreams& all, Extractor& files) {
  std::string text = "scan,image,image_less_scan_s\n";
  for (const BagPairing& pairing : all.pairings) {
    const BagStream& scans = all.streams[pairing.scans];
    const BagStream& images = all.streams[pairing.images];
    for (const StampPair& pair : pairing.pairs.pairs) {
      text += fmt::format("{},{},{:.9f}\n",
                          files.FileName(scans.topic, pair.first, scans.stamps_ns[pair.first]),
                          files.FileName(images.topic, pair.second, images.stamps_ns[pair.second]),
                          1e-9 * static_cast<double>(pair.difference_ns));
    }
  }
  return text;
}

Expected<int> ExtractBag(const Bag& bag, const BagStreams& streams, const std::string& folder) {
  SEXTANT_ASSIGN_OR_RETURN(const OutputFolder locked, OutputFolder::Open(folder));
  const std::filesystem::path pairs = std::filesystem::path(folder) / "pairs.csv";
  SEXTANT_RETURN_IF_ERROR(ClaimOutput(pairs));
  Extractor files(bag, folder);
  std::vector<std::size_t> topics;
  for (std::size_t i = 0; i < bag.topics().size(); ++i) {
    if (bag.topics()[i].kind != MessageKind::kOther) topics.push_back(i);
  }
  const Expected<void> read =
      bag.Read(topics, [&files](const BagMessage& message) { return files.Take(message); });
  if (!read) return tl::unexpected<Error>(read.error());
  if (files.files() == 0) {
    return MakeError(ErrorCode::kMissingData, "there is nothing in it to extract");
  }
  SEXTANT_RETURN_IF_ERROR(WriteFileAtomically(pairs, PairsText(streams, files)));
  return files.files() + 1;
}

}  // namespace

Expected<OpenedRecording> OpenRecording(const std::string& path, double tolerance_s) {
  SEXTANT_ASSIGN_OR_RETURN(std::unique_ptr<Bag> opened, OpenBag(path));
  const std::shared_ptr<Bag> bag = std::move(opened);
  const auto tolerance_ns = static_cast<std::int64_t>(1e9 * tolerance_s);
  SEXTANT_ASSIGN_OR_RETURN(const BagStreams streams, ReadStreams(*bag, tolerance_ns));
  return OpenedRecording{.summary = DescribeRecording(*bag, streams, path, tolerance_s),
                         .extract = [bag, streams](const std::string& folder) {
                           return ExtractBag(*bag, streams, folder);
                         }};
}

}  // namespace sextant::cli
