// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <map>

#include "base/random.h"
#include "io/bag/bag.h"
#include "io/bag/messages.h"
#include "io/bag/open_bytes.h"
#include "io/bag/rosbag1_writer.h"
#include "support/real_data.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kStart = 1'700'000'000 * kSecond;

CloudMessage SomeScan(int seed, int points) {
  Random random(static_cast<std::uint64_t>(seed));
  CloudMessage scan{{kStart + seed, "velodyne"}, {}};
  for (int i = 0; i < points; ++i) {
    // Values that a float32 represents exactly.
    scan.cloud.points.emplace_back(static_cast<float>(random.Uniform(-9, 9)), 0.125 * i, -0.25);
    scan.cloud.intensity.push_back(static_cast<float>(i));
    scan.cloud.ring.push_back(static_cast<std::uint16_t>(i % 2 == 0 ? 3 : 0));
    scan.cloud.time_s.push_back(0.125 * (i % 8));
  }
  return scan;
}

ImageMessage SomeImage() {
  return {{kStart + 7, "camera"}, 4, 3, "mono8", false, 5, "0123456789abcde"};
}

EncodedImageMessage SomeJpeg() {
  EncodedImageMessage image;
  image.header = {kStart, "c"};
  image.format = "jpeg";
  image.data = "\xff\xd8\xff-";
  return image;
}

CameraInfoMessage SomeCamera(CameraModel model) {
  CameraInfoMessage info{{kStart + 9, "camera"}, {}};
  info.camera = {.model = model,
                 .width_px = 640,
                 .height_px = 480,
                 .fx_px = 500,
                 .fy_px = 501,
                 .cx_px = 320,
                 .cy_px = 240};
  if (model != CameraModel::kPinhole) info.camera.distortion = {-0.1, 0.01, 0.001, -0.002};
  return info;
}

void Require(const Expected<void>& done) { ASSERT_TRUE(done) << done.error().message; }

// Two scans, an image of each kind, and cameras of all models.
std::filesystem::path WrittenBag(BagCompression compression, int points = 40) {
  std::filesystem::path path = test::TestFolder() / "session.bag";
  Expected<Rosbag1Writer> writer = Rosbag1Writer::Create(path, compression);
  EXPECT_TRUE(writer) << writer.error().message;
  Require(writer->Write("/points", kStart, SomeScan(1, points)));
  Require(writer->Write("/image_raw", kStart + 1, SomeImage()));
  Require(writer->Write("/image/compressed", kStart + 2, SomeJpeg()));
  int i = 0;
  for (const CameraModel model :
       {CameraModel::kPinhole, CameraModel::kBrownConrady, CameraModel::kEquidistant}) {
    Require(writer->Write("/camera_info", kStart + 10 + i++, SomeCamera(model)));
  }
  Require(writer->Write("/points", kStart + kSecond, SomeScan(2, points)));
  Require(writer->Close());
  return path;
}

std::vector<std::size_t> AllTopics(const Bag& bag) {
  std::vector<std::size_t> all(bag.topics().size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

class RoundTripTest : public testing::TestWithParam<BagCompression> {};

TEST_P(RoundTripTest, EveryMessageComesBackToTheBit) {
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(WrittenBag(GetParam(), 3000));
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_EQ((*bag)->format(), "ROS 1 bag");
  ASSERT_EQ((*bag)->topics().size(), 4U);
  std::vector<CloudMessage> scans;
  std::vector<Camera> cameras;
  int images = 0;
  const Expected<void> read =
      (*bag)->Read(AllTopics(**bag), [&](const BagMessage& message) -> Expected<void> {
        switch (message.topic->kind) {
          case MessageKind::kPointCloud:
            scans.push_back(DecodePointCloud(message).value());
            break;
          case MessageKind::kImage: {
            const ImageMessage image = DecodeImage(message).value();
            EXPECT_EQ(image.header.stamp_ns, kStart + 7);
            EXPECT_EQ(image.header.frame, "camera");
            EXPECT_EQ(image.width_px, 4);
            EXPECT_EQ(image.row_bytes, 5U);
            EXPECT_EQ(image.encoding, "mono8");
            EXPECT_EQ(image.data, "0123456789abcde");
            ++images;
            break;
          }
          case MessageKind::kEncodedImage:
            EXPECT_EQ(ExtensionOf(DecodeEncodedImage(message).value()), "jpg");
            ++images;
            break;
          case MessageKind::kCameraInfo:
            cameras.push_back(DecodeCameraInfo(message).value().camera);
            break;
          case MessageKind::kOther:
            ADD_FAILURE() << message.topic->type;
        }
        return {};
      });
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(images, 2);
  ASSERT_EQ(scans.size(), 2U);
  const CloudMessage expected = SomeScan(2, 3000);
  EXPECT_EQ(scans[1].header.stamp_ns, expected.header.stamp_ns);
  EXPECT_EQ(scans[1].cloud.points, expected.cloud.points);
  EXPECT_EQ(scans[1].cloud.intensity, expected.cloud.intensity);
  EXPECT_EQ(scans[1].cloud.ring.size(), expected.cloud.ring.size());
  EXPECT_EQ(scans[1].cloud.time_s, expected.cloud.time_s);
  ASSERT_EQ(cameras.size(), 3U);
  EXPECT_EQ(cameras[0].model, CameraModel::kPinhole);
  EXPECT_EQ(cameras[1].distortion, SomeCamera(CameraModel::kBrownConrady).camera.distortion);
  EXPECT_EQ(cameras[2].model, CameraModel::kEquidistant);
}

INSTANTIATE_TEST_SUITE_P(Compressions, RoundTripTest,
                         testing::Values(BagCompression::kNone, BagCompression::kBz2,
                                         BagCompression::kLz4));

// CameraInfo has no xi: the lens would read back as another one.
TEST(Rosbag1Writer, RefusesACameraForWhichCameraInfoHasNoPlace) {
  Expected<Rosbag1Writer> writer = Rosbag1Writer::Create(test::TestFolder() / "xi.bag");
  ASSERT_TRUE(writer) << writer.error().message;
  CameraInfoMessage info = SomeCamera(CameraModel::kOmnidirectional);
  info.camera.xi = 1.3;
  const Expected<void> written = writer->Write("/camera_info", kStart, info);
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("omnidirectional: it has no place for xi"));
}

#ifdef SEXTANT_ROSBAG_DUMP
TEST_P(RoundTripTest, RosReadsWhatWeWrite) {
  const test::ProgramRun run =
      test::RunProgram(SEXTANT_ROSBAG_DUMP, WrittenBag(GetParam(), 3000).string());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const std::string scan = " velodyne 3000 22 x0 y4 z8 intensity12 ring16 time18\n";
  EXPECT_EQ(run.out, "/points 1700000000000000000" + scan +
                         "/image_raw 1700000000000000001 4 3 mono8 0123456789abcde\n"
                         "/image/compressed 1700000000000000002 jpeg 4\n"
                         "/camera_info 1700000000000000010 plumb_bob 5 500 501 0\n"
                         "/camera_info 1700000000000000011 plumb_bob 5 500 501 0\n"
                         "/camera_info 1700000000000000012 equidistant 4 500 501 0\n"
                         "/points 1700000001000000000" +
                         scan);
}
#endif

TEST(Rosbag1, TopicsHaveCountsAndTimes) {
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(WrittenBag(BagCompression::kLz4));
  ASSERT_TRUE(bag) << bag.error().message;
  for (const BagTopic& topic : (*bag)->topics()) {
    if (topic.name != "/points") continue;
    EXPECT_EQ(topic.type, "sensor_msgs/PointCloud2");
    EXPECT_EQ(topic.count, 2U);
    EXPECT_EQ(topic.first_ns, kStart);
    EXPECT_EQ(topic.last_ns, kStart + kSecond);
  }
}

std::size_t CountMessages(const Bag& bag) {
  std::size_t count = 0;
  const Expected<void> read = bag.Read(AllTopics(bag), [&](const BagMessage&) -> Expected<void> {
    ++count;
    return {};
  });
  EXPECT_TRUE(read) << read.error().message;
  return count;
}

// The file of a recorder that was killed: no index, and no reference to one.
TEST(Rosbag1, IsReadWithoutItsIndex) {
  std::string bytes = test::ReadText(WrittenBag(BagCompression::kNone));
  const std::size_t index_pos = bytes.find("index_pos=") + 10;
  std::uint64_t end = 0;
  std::memcpy(&end, bytes.data() + index_pos, sizeof(end));
  bytes.resize(end);
  bytes.replace(index_pos, 8, std::string(8, '\0'));
  const Expected<std::unique_ptr<Bag>> bag = OpenRosbag1(bytes, "f", nullptr);
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_EQ((*bag)->topics().size(), 4U);
  EXPECT_EQ(CountMessages(**bag), 7U);
}

TEST(Rosbag1, WriterRefusesWhatAToolOfRosCouldNotRead) {
  const std::filesystem::path path = test::TestFolder() / "refused.bag";
  {
    Expected<Rosbag1Writer> writer = Rosbag1Writer::Create(path);
    ASSERT_TRUE(writer) << writer.error().message;
    Require(writer->Write("/a", kStart, SomeImage()));
    const Expected<void> other = writer->Write("/a", kStart, SomeScan(1, 2));
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message, HasSubstr("its type is sensor_msgs/Image"));
    EXPECT_EQ(writer->Write("/b", -1, SomeImage()).error().code, ErrorCode::kInvalidInput);
    ImageMessage cut = SomeImage();
    cut.data.pop_back();
    EXPECT_EQ(writer->Write("/b", kStart, cut).error().code, ErrorCode::kInvalidInput);
  }
  EXPECT_TRUE(std::filesystem::is_empty(path.parent_path())) << "nothing is left of it";
  EXPECT_EQ(Rosbag1Writer::Create("/proc/none/a.bag").error().code, ErrorCode::kUnwritable);
}

// Decodes all messages of a bag; returns the first error's message, or nothing.
std::string ReadAll(const Expected<std::unique_ptr<Bag>>& bag) {
  if (!bag) return bag.error().message;
  const Expected<void> read =
      (*bag)->Read(AllTopics(**bag), [](const BagMessage& message) -> Expected<void> {
        const auto check = [](const auto& decoded) -> Expected<void> {
          if (!decoded) return tl::unexpected<Error>(decoded.error());
          return {};
        };
        switch (message.topic->kind) {
          case MessageKind::kPointCloud:
            return check(DecodePointCloud(message));
          case MessageKind::kImage:
            return check(DecodeImage(message));
          case MessageKind::kEncodedImage:
            return check(DecodeEncodedImage(message));
          case MessageKind::kCameraInfo:
            return check(DecodeCameraInfo(message));
          case MessageKind::kOther:
            break;
        }
        return {};
      });
  return read ? std::string() : read.error().message;
}

std::size_t MessagesOf(const Bag& bag) {
  std::size_t messages = 0;
  const Expected<void> read = bag.Read(AllTopics(bag), [&](const BagMessage&) -> Expected<void> {
    ++messages;
    return {};
  });
  EXPECT_TRUE(read) << read.error().message;
  return messages;
}

TEST(Rosbag1, EveryTruncationIsReadUpToTheCutOrRefusedWithTheByte) {
  for (const BagCompression compression :
       {BagCompression::kNone, BagCompression::kBz2, BagCompression::kLz4}) {
    const std::string bytes = test::ReadText(WrittenBag(compression, 4));
    const Expected<std::unique_ptr<Bag>> whole = OpenRosbag1(bytes, "f", nullptr);
    ASSERT_EQ(ReadAll(whole), "");
    EXPECT_FALSE((*whole)->cut());
    EXPECT_EQ(DescribeCut(**whole), "");
    const std::size_t all = MessagesOf(**whole);
    std::size_t most = 0;
    for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 2000) {
      const std::string_view begun = std::string_view(bytes).substr(0, size);
      const Expected<std::unique_ptr<Bag>> bag = OpenRosbag1(begun, "f", nullptr);
      if (!bag) {
        EXPECT_THAT(bag.error().message, testing::StartsWith("f: byte ")) << size;
        EXPECT_EQ(most, 0U) << "a longer beginning lost what a shorter one has: " << size;
        continue;
      }
      ASSERT_TRUE((*bag)->cut()) << size;
      EXPECT_LE((*bag)->cut()->byte, size);
      std::size_t counted = 0;
      for (const BagTopic& topic : (*bag)->topics()) counted += topic.count;
      EXPECT_EQ(MessagesOf(**bag), counted) << size;
      EXPECT_GE(counted, most) << size;
      EXPECT_THAT(DescribeCut(**bag),
                  HasSubstr("the " + std::to_string(counted) + " messages before it are read"));
      most = std::max(most, counted);
    }
    EXPECT_EQ(most, all);
  }
}

// The messages of a plain chunk that is cut come back one by one.
TEST(Rosbag1, AChunkThatIsCutGivesItsFirstMessages) {
  const std::string bytes = test::ReadText(WrittenBag(BagCompression::kNone, 4));
  const std::size_t last_scan = bytes.rfind("velodyne");  // In the last message of the chunk.
  const std::string_view begun = std::string_view(bytes).substr(0, last_scan);
  const Expected<std::unique_ptr<Bag>> bag = OpenRosbag1(begun, "f", nullptr);
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_EQ(MessagesOf(**bag), 6U);
  EXPECT_THAT(DescribeCut(**bag), testing::StartsWith("the file ends within a record (byte 4109)"));
}

TEST(Rosbag1, FiftyThousandTopicsTakeSeconds) {
  const std::filesystem::path path = test::TestFolder() / "topics.bag";
  Expected<Rosbag1Writer> writer = Rosbag1Writer::Create(path, BagCompression::kNone);
  ASSERT_TRUE(writer);
  constexpr int kTopics = 50'000;
  for (int i = 0; i < kTopics; ++i) {
    Require(writer->Write("/camera/" + std::to_string(i), kStart + i, SomeJpeg()));
  }
  Require(writer->Close());
  const auto start = std::chrono::steady_clock::now();
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(path);
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_EQ((*bag)->topics().size(), 50'000U);
  EXPECT_EQ(MessagesOf(**bag), 50'000U);
  // 0.3 s here; a search of all topics for each of them takes 8 s.
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(4));
}

TEST(Rosbag1, EveryDamageIsReadOrRefused) {
  for (const BagCompression compression :
       {BagCompression::kNone, BagCompression::kBz2, BagCompression::kLz4}) {
    const std::string whole = test::ReadText(WrittenBag(compression, 4));
    Random random(3);
    for (int trial = 0; trial < 1500; ++trial) {
      std::string bytes = whole;
      const std::uint64_t at =
          random.Below(4) == 0 ? random.Below(120) : 4100 + random.Below(whole.size() - 4100);
      bytes[at] = static_cast<char>(random.Below(256));
      if (random.Below(2) == 0) bytes[at + random.Below(4)] = '\xff';
      const std::string message = ReadAll(OpenRosbag1(bytes, "f", nullptr));
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_LT(message.size(), 500U) << message;
    }
  }
}

TEST(Rosbag1, OldVersionsAndOtherFilesAreNamed) {
  EXPECT_THAT(ReadAll(OpenRosbag1(std::string_view("#ROSBAG V1.2\n"), "f", nullptr)),
              HasSubstr("expected a ROS 1 bag of version 2.0"));
  const std::filesystem::path path = test::TestFolder() / "a.bag";
  test::WriteText(path, "not a recording");
  EXPECT_THAT(ReadAll(OpenBag(path)), HasSubstr("byte 0: expected a recording: .bag of ROS 1"));
  EXPECT_THAT(ReadAll(OpenBag(path.parent_path() / "none.bag")), HasSubstr("cannot read"));
}

TEST(Rosbag1, ReadsARealRecording) {
  SEXTANT_REAL_DATA(path, "fiducials/aruco_images.bag");
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(path);
  ASSERT_TRUE(bag) << bag.error().message;
  std::map<std::string, std::size_t> counts;
  for (const BagTopic& topic : (*bag)->topics()) counts[topic.type] += topic.count;
  EXPECT_EQ(counts["sensor_msgs/CameraInfo"], 15U);
  EXPECT_EQ(counts["sensor_msgs/CompressedImage"], 1U);
  EXPECT_EQ(ReadAll(bag), "");
  const Expected<void> read =
      (*bag)->Read(AllTopics(**bag), [](const BagMessage& message) -> Expected<void> {
        if (message.topic->kind == MessageKind::kCameraInfo) {
          EXPECT_GT(DecodeCameraInfo(message).value().camera.fx_px, 100.0);
        } else if (message.topic->kind == MessageKind::kEncodedImage) {
          EXPECT_EQ(ExtensionOf(DecodeEncodedImage(message).value()), "jpg");
        }
        return {};
      });
  EXPECT_TRUE(read);
}

TEST(Rosbag1, ReadsLivoxCustomMessagesOfARealRecording) {
  SEXTANT_REAL_DATA(path, "field/bags/livox_custom.bag");
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(path);
  ASSERT_TRUE(bag) << bag.error().message;
  std::size_t clouds = 0;
  const Expected<void> read =
      (*bag)->Read(AllTopics(**bag), [&](const BagMessage& message) -> Expected<void> {
        if (message.topic->kind != MessageKind::kPointCloud) return {};
        EXPECT_THAT(message.topic->type, HasSubstr("CustomMsg"));
        const Expected<CloudMessage> scan = DecodePointCloud(message);
        EXPECT_TRUE(scan) << scan.error().message;
        EXPECT_GT(scan->cloud.points.size(), 100U);
        EXPECT_EQ(scan->cloud.time_s.size(), scan->cloud.points.size());
        EXPECT_EQ(scan->cloud.intensity.size(), scan->cloud.points.size());
        for (std::size_t i = 0; i < scan->cloud.points.size(); ++i) {
          EXPECT_LT(scan->cloud.points[i].norm(), 500.0);
          EXPECT_LT(scan->cloud.time_s[i], 1.0);
        }
        ++clouds;
        return {};
      });
  EXPECT_TRUE(read) << read.error().message;
  EXPECT_GT(clouds, 0U);
}

// As in a file: the scan is refused, with what to do.
TEST(Rosbag1, AScanInMillimetresIsRefused) {
  const std::string path = test::TestPath("mm.bag");
  Expected<Rosbag1Writer> writer = Rosbag1Writer::Create(path);
  ASSERT_TRUE(writer) << writer.error().message;
  CloudMessage scan{{kStart, "lidar"}, {}};
  for (int i = 0; i < 9; ++i) scan.cloud.points.emplace_back(3000.0, 100.0 * i, -250.0);
  Require(writer->Write("/points", kStart, scan));
  Require(writer->Close());
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(path);
  ASSERT_TRUE(bag) << bag.error().message;
  const Expected<void> read = (*bag)->Read({0}, [](const BagMessage& message) -> Expected<void> {
    const Expected<CloudMessage> cloud = DecodePointCloud(message);
    if (!cloud) return tl::unexpected<Error>(cloud.error());
    return {};
  });
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, testing::HasSubstr("If these are millimetres"));
}

}  // namespace
}  // namespace sextant
