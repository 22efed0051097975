// SPDX-License-Identifier: Apache-2.0
// Recordings of ROS 2: the seeds of the fuzz targets, written by other tools, and damaged copies.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "base/random.h"
#include "io/bag/bag.h"
#include "io/bag/messages.h"
#include "io/bag/open_bytes.h"
#include "support/run_program.h"
#include "support/source_tree.h"

namespace sextant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::filesystem::path Seed(const std::string& name) {
  return test::SourceRoot() / "tests/fuzz/corpus" / name;
}

// Each container, with each compression, has one cloud and one camera.
class SeedTest : public testing::TestWithParam<const char*> {};

TEST_P(SeedTest, HasACloudAndACamera) {
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(Seed(GetParam()));
  ASSERT_TRUE(bag) << bag.error().message;
  ASSERT_EQ((*bag)->topics().size(), 2U);
  EXPECT_EQ((*bag)->topics()[0].type, "sensor_msgs/PointCloud2");
  EXPECT_EQ((*bag)->topics()[1].name, "/info");
  EXPECT_EQ((*bag)->topics()[1].first_ns, 9);
  int seen = 0;
  const Expected<void> read =
      (*bag)->Read({0, 1}, [&](const BagMessage& message) -> Expected<void> {
        ++seen;
        EXPECT_EQ(DecodeHeader(message).value().stamp_ns, 5'000'000'007);
        EXPECT_EQ(DecodeHeader(message).value().frame, "lidar");
        if (message.topic_index == 0) {
          const PointCloud cloud = DecodePointCloud(message).value().cloud;
          EXPECT_THAT(cloud.points,
                      ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
          EXPECT_THAT(cloud.ring, testing::UnorderedElementsAre(0, 1));
        } else {
          const Camera camera = DecodeCameraInfo(message).value().camera;
          EXPECT_EQ(camera.fx_px, 500.0);
          EXPECT_EQ(camera.width_px, 640);
          EXPECT_EQ(camera.distortion[0], 0.1);
        }
        return {};
      });
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(seen, 2);
}

INSTANTIATE_TEST_SUITE_P(Seeds, SeedTest,
                         testing::Values("mcap/plain", "mcap/lz4", "mcap/zstd", "rosbag2/plain",
                                         "rosbag2/zstd"));

// The first error of opening a recording and decoding all of it; empty if there is none.
std::string FirstError(const Expected<std::unique_ptr<Bag>>& bag) {
  if (!bag) return bag.error().message;
  std::vector<std::size_t> all((*bag)->topics().size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  const Expected<void> read = (*bag)->Read(all, [](const BagMessage& message) -> Expected<void> {
    const auto cloud = DecodePointCloud(message);
    const auto camera = DecodeCameraInfo(message);
    if (cloud || camera) return {};
    return tl::unexpected<Error>(message.topic->kind == MessageKind::kCameraInfo ? camera.error()
                                                                                 : cloud.error());
  });
  return read ? std::string() : read.error().message;
}

TEST(Ros2, EveryDamageIsReadOrRefusedInOneLine) {
  const std::filesystem::path damaged = test::TestFolder() / "damaged.db3";
  for (const char* name : {"mcap/plain", "mcap/lz4", "mcap/zstd", "rosbag2/plain"}) {
    const std::string whole = test::ReadText(Seed(name));
    Random random(4);
    int refused = 0;
    for (int trial = 0; trial < 400; ++trial) {
      std::string bytes = whole;
      const std::uint64_t at = random.Below(bytes.size());
      bytes[at] = static_cast<char>(random.Below(256));
      if (random.Below(4) == 0) bytes.resize(random.Below(bytes.size()));
      if (!std::string(name).starts_with("mcap")) test::WriteText(damaged, bytes);
      const Expected<std::unique_ptr<Bag>> bag = std::string(name).starts_with("mcap")
                                                     ? OpenMcap(bytes, "f", nullptr)
                                                     : OpenRosbag2Sqlite(damaged);
      const std::string message = FirstError(bag);
      refused += message.empty() && !(*bag)->cut() ? 0 : 1;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_LT(message.size(), 700U) << message;
    }
    EXPECT_GT(refused, 100) << name;
  }
}

std::size_t CountRead(const Bag& bag) {
  std::vector<std::size_t> all(bag.topics().size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  std::size_t messages = 0;
  const Expected<void> read = bag.Read(all, [&](const BagMessage&) -> Expected<void> {
    ++messages;
    return {};
  });
  EXPECT_TRUE(read) << read.error().message;
  return messages;
}

TEST(Ros2, McapIsReadUpToEveryCut) {
  for (const char* name : {"mcap/plain", "mcap/lz4", "mcap/zstd"}) {
    const std::string bytes = test::ReadText(Seed(name));
    EXPECT_FALSE((*OpenMcap(bytes, "f", nullptr))->cut()) << name;
    std::size_t most = 0;
    for (std::size_t size = 8; size < bytes.size(); ++size) {
      const std::string_view begun = std::string_view(bytes).substr(0, size);
      const Expected<std::unique_ptr<Bag>> bag = OpenMcap(begun, "f", nullptr);
      if (!bag) {
        EXPECT_EQ(most, 0U) << name << " " << size;
        EXPECT_THAT(bag.error().message, HasSubstr("before its first message")) << size;
        continue;
      }
      const std::size_t read = CountRead(**bag);
      EXPECT_GE(read, most) << name << " " << size;
      most = std::max(most, read);
    }
    EXPECT_EQ(most, 2U) << name;
  }
}

// rosbag2's tables with scans, as large as real ones: each takes pages of its own.
std::filesystem::path DatabaseOfScans(int scans) {
  const std::filesystem::path path = test::TestFolder() / "scans.db3";
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  std::string sql =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format "
      "TEXT);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data "
      "BLOB);"
      "CREATE INDEX timestamp_idx ON messages(timestamp ASC);"
      "INSERT INTO topics VALUES(1, '/points', 'sensor_msgs/msg/PointCloud2', 'cdr');";
  for (int i = 0; i < scans; ++i) {
    sql += "INSERT INTO messages(topic_id, timestamp, data) VALUES(1, " + std::to_string(i + 1) +
           ", zeroblob(20000));";
  }
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  return path;
}

TEST(Ros2, ADatabaseIsReadUpToTheCut) {
  const std::filesystem::path path = DatabaseOfScans(50);
  const std::uintmax_t size = std::filesystem::file_size(path);
  EXPECT_EQ(CountRead(**OpenBag(path)), 50U);
  std::size_t before = 50;
  for (const double part : {0.99, 0.75, 0.5, 0.1}) {
    std::filesystem::resize_file(path,
                                 static_cast<std::uintmax_t>(part * static_cast<double>(size)));
    const Expected<std::unique_ptr<Bag>> bag = OpenBag(path);
    ASSERT_TRUE(bag) << part << " " << bag.error().message;
    ASSERT_TRUE((*bag)->cut()) << part;
    const std::size_t read = CountRead(**bag);
    EXPECT_EQ((*bag)->topics()[0].count, read);
    EXPECT_NEAR(static_cast<double>(read), 50.0 * part, 4.0);
    EXPECT_LE(read, before);
    before = read;
  }
}

BagMessage Message(const BagTopic& topic, std::string_view data) { return {&topic, 0, 9, data}; }

TEST(Ros2, InconsistentMessagesAreRefusedWithTheField) {
  const BagTopic topic{.name = "/points",
                       .type = "sensor_msgs/PointCloud2",
                       .kind = MessageKind::kPointCloud,
                       .encoding = MessageEncoding::kCdr};
  const auto refusal = [&](std::string_view data) {
    return DecodePointCloud(Message(topic, data)).error().message;
  };
  EXPECT_THAT(refusal(""),
              HasSubstr("/points at 0.000000009 s: encapsulation: expected plain CDR"));
  EXPECT_THAT(refusal(std::string(4, '\0')), HasSubstr("header.stamp: extends beyond the message"));
  // Little endian: stamp, frame "", height 1, width 1, then 2^31 fields.
  std::string lying(
      "\0\1\0\0"
      "\5\0\0\0"
      "\7\0\0\0"
      "\1\0\0\0"
      "\0\0\0\0"
      "\1\0\0\0"
      "\1\0\0\0"
      "\0\0\0\x80",
      32);
  EXPECT_THAT(refusal(lying), HasSubstr("fields: has 2147483648 entries"));
}

TEST(Ros2, AFolderIsTheOneRecordingInIt) {
  const std::filesystem::path folder = test::TestFolder() / "session";
  std::filesystem::create_directory(folder);
  EXPECT_THAT(OpenBag(folder).error().message, HasSubstr("has no .db3"));
  std::filesystem::copy_file(Seed("rosbag2/plain"), folder / "session_0.db3");
  EXPECT_TRUE(OpenBag(folder));
  std::filesystem::copy_file(Seed("mcap/plain"), folder / "session_1.mcap");
  EXPECT_THAT(OpenBag(folder).error().message, HasSubstr("has 2 recordings; name one of them"));
}

TEST(Ros2, ADatabaseOfSomethingElseIsNamed) {
  const std::filesystem::path path = test::TestFolder() / "other.db3";
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  sqlite3_exec(database, "CREATE TABLE a(b)", nullptr, nullptr, nullptr);
  sqlite3_close(database);
  EXPECT_THAT(
      OpenBag(path).error().message,
      HasSubstr("expected a recording of ROS 2 (SQLite with the tables topics and messages)"));
}

// Recordings that were merged list a topic twice; its times are those of both.
TEST(Ros2, ATopicThatIsListedTwiceIsOne) {
  const std::filesystem::path path = test::TestFolder() / "merged.db3";
  std::filesystem::copy_file(Seed("rosbag2/plain"), path);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  const char* const twice =
      "INSERT INTO topics(id, name, type, serialization_format)"
      " SELECT 99, name, type, serialization_format FROM topics WHERE name = '/info';"
      "INSERT INTO messages(topic_id, timestamp, data) SELECT 99, 4, data FROM messages"
      " WHERE topic_id = 2;";
  EXPECT_EQ(sqlite3_exec(database, twice, nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(path);
  ASSERT_TRUE(bag) << bag.error().message;
  ASSERT_EQ((*bag)->topics().size(), 2U);
  const BagTopic& info = (*bag)->topics()[1];
  EXPECT_EQ(info.name, "/info");
  EXPECT_EQ(info.count, 2U);
  EXPECT_EQ(info.first_ns, 4);
  EXPECT_EQ(info.last_ns, 9);
}

// livox_ros_driver2's message, aligned as CDR: a point takes 19 bytes and one of padding.
TEST(LivoxMessage, OfRos2IsReadWithItsPadding) {
  std::string data("\x00\x01\x00\x00", 4);
  const auto put = [&data](auto value) {
    while ((data.size() - 4) % sizeof(value) != 0) data.push_back('\0');
    data.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  put(std::int32_t{5});
  put(std::uint32_t{7});
  put(std::uint32_t{6});
  data.append("lidar\0", 6);
  put(std::uint64_t{5'000'000'007});
  put(std::uint32_t{2});
  put(std::uint8_t{1});
  for (int i = 0; i < 3; ++i) put(std::uint8_t{0});
  put(std::uint32_t{2});
  for (int i = 0; i < 2; ++i) {
    put(static_cast<std::uint32_t>(1000 * i));
    for (const float value : {1.0F, 2.0F, 3.0F + static_cast<float>(i)}) put(value);
    put(static_cast<std::uint8_t>(40 + i));
    put(std::uint8_t{16});
    put(std::uint8_t{3});
  }
  BagTopic topic{.name = "/livox/lidar", .type = "livox_ros_driver2/CustomMsg"};
  topic.kind = MessageKindOf(topic.type);
  topic.encoding = MessageEncoding::kCdr;
  EXPECT_EQ(topic.kind, MessageKind::kPointCloud);
  BagMessage message{.topic = &topic, .topic_index = 0, .time_ns = 0, .data = data};
  const Expected<CloudMessage> scan = DecodePointCloud(message);
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_EQ(scan->header.frame, "lidar");
  EXPECT_THAT(scan->cloud.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(1, 2, 4)));
  EXPECT_THAT(scan->cloud.intensity, ElementsAre(40.0F, 41.0F));
  EXPECT_THAT(scan->cloud.time_s, ElementsAre(0.0, 1e-6));
  // No sensor measures that far: a ray without a return.
  const float far = 1e30F;
  std::string beyond = data;
  beyond.replace(beyond.size() - 19 + 4, sizeof(far), reinterpret_cast<const char*>(&far),
                 sizeof(far));
  message.data = beyond;
  const Expected<CloudMessage> without = DecodePointCloud(message);
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_TRUE(without->cloud.points[0].allFinite());
  EXPECT_FALSE(without->cloud.points[1].allFinite());
  message.data = std::string_view(data).substr(0, data.size() - 12);
  EXPECT_THAT(DecodePointCloud(message).error().message, HasSubstr("points"));
}

}  // namespace
}  // namespace sextant
