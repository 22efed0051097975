// SPDX-License-Identifier: Apache-2.0
#include "calibrate/bag/observe_bag.h"

#include <gmock/gmock.h>

#include <atomic>
#include <map>
#include <memory>
#include <utility>

#include "calibrate/bag/bag_streams.h"
#include "calibrate/bag/observe_recording.h"
#include "calibrate/calibrate.h"
#include "eval/extractors/board_scenes.h"
#include "io/bag/rosbag1_writer.h"
#include "simulator/scene/camera_model.h"
#include "support/calibration_scene.h"
#include "support/scratch_folder.h"

namespace sextant::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kStart_ns = 1'000'000'000;

struct Frame {
  std::size_t data = 0;  // Into Recorded::data.
  std::int64_t cloud_ns = 0;
  std::int64_t image_ns = 0;
};

// Ten thousand pairs of topics, of which none has a common message.
TEST(ReadStreams, PairsTheFirstHundredPairsOfTopics) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder.path() / "topics.bag";
  Expected<Rosbag1Writer> writer = Rosbag1Writer::Create(path);
  ASSERT_TRUE(writer);
  for (int i = 0; i < 100; ++i) {
    const MessageHeader header{.stamp_ns = kStart_ns + i, .frame = "f"};
    ASSERT_TRUE(writer->Write("/scan" + std::to_string(i), kStart_ns, CloudMessage{header, {}}));
    ASSERT_TRUE(writer->Write("/image" + std::to_string(i), kStart_ns,
                              EncodedImageMessage{header, "jpeg", "x"}));
  }
  ASSERT_TRUE(writer->Close());
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(path);
  ASSERT_TRUE(bag);
  const Expected<BagStreams> all = ReadStreams(**bag, 1000);
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_EQ(all->streams.size(), 200U);
  EXPECT_EQ(all->pairings.size(), kMaxPairings);
  EXPECT_EQ(all->more_pairings, 9900U);
  const Expected<BagStreams> one =
      ReadStreams(**bag, 1000, {.image_topic = "/image7", .cloud_topic = "/scan99"});
  ASSERT_TRUE(one);
  ASSERT_EQ(one->pairings.size(), 1U);
  EXPECT_EQ(one->pairings[0].pairs.pairs.size(), 1U);
  EXPECT_THAT(PlanBag(**bag, {}).error().message,
              AllOf(HasSubstr("several topics fit"), HasSubstr("and 9980 more")));
}

// Drivers of cameras without a calibration publish zeros; the user has a file of the intrinsics.
TEST(PlanBag, ACameraThatWasNeverCalibratedIsNoObstacle) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder.path() / "zeros.bag";
  Expected<Rosbag1Writer> writer = Rosbag1Writer::Create(path);
  ASSERT_TRUE(writer);
  const MessageHeader header{.stamp_ns = kStart_ns, .frame = "f"};
  PointCloud cloud;
  cloud.points = {Eigen::Vector3d::UnitX()};
  ASSERT_TRUE(writer->Write("/scan", kStart_ns, CloudMessage{.header = header, .cloud = cloud}));
  ASSERT_TRUE(writer->Write("/cam/image", kStart_ns,
                            ImageMessage{.header = header,
                                         .width_px = 1,
                                         .height_px = 1,
                                         .encoding = "mono8",
                                         .row_bytes = 1,
                                         .data = "x"}));
  ASSERT_TRUE(writer->Write("/cam/camera_info", kStart_ns, CameraInfoMessage{.header = header}));
  ASSERT_TRUE(writer->Close());
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(path);
  ASSERT_TRUE(bag);
  const Expected<BagPlan> plan = PlanBag(**bag, {});
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_FALSE(plan->camera);
  const Expected<RecordedViews> without = ObserveRecording(path, {}, {});
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error().message,
              AllOf(HasSubstr("camera_info"), HasSubstr("give the intrinsics with --camera")));
}

class Recording : public testing::Test {
 protected:
  // The scene with its boards moved sideways by so much, for each; rendered once per process.
  void Record(const std::vector<double>& moved_m) {
    static std::map<std::pair<std::size_t, double>, SensorData> recorded;
    Random random(DeriveSeed(1, "observe_bag", 0, 0));
    const Scene scene = TaggedBoards(random);
    boards_ = BoardsIn(scene);
    for (std::size_t i = 0; i < moved_m.size(); ++i) {
      const auto [entry, is_new] = recorded.try_emplace({i, moved_m[i]});
      if (is_new) {
        Scene now = scene;
        for (SceneBoard& board : now.boards) board.world_from_board.translation.y() += moved_m[i];
        entry->second = test::Record(now, i);
      }
      data_.push_back(entry->second);
    }
  }

  std::unique_ptr<Bag> Write(const std::vector<Frame>& frames, bool second_camera = false) const {
    const std::filesystem::path path = folder_.path() / "session.bag";
    Expected<Rosbag1Writer> writer = Rosbag1Writer::Create(path);
    EXPECT_TRUE(writer);
    for (const Frame& frame : frames) {
      const SensorData& data = data_[frame.data];
      const CloudMessage cloud{.header = {.stamp_ns = frame.cloud_ns, .frame = "lidar"},
                               .cloud = data.cloud};
      EXPECT_TRUE(writer->Write("/lidar/points", frame.cloud_ns, cloud));
      ImageMessage image{.header = {.stamp_ns = frame.image_ns, .frame = "cam"},
                         .width_px = data.image.cols,
                         .height_px = data.image.rows,
                         .encoding = "mono8",
                         .row_bytes = data.image.step[0]};
      image.data.assign(reinterpret_cast<const char*>(data.image.data),
                        data.image.step[0] * static_cast<std::size_t>(data.image.rows));
      EXPECT_TRUE(writer->Write("/cam/image_raw", frame.image_ns, image));
      if (second_camera) {
        EXPECT_TRUE(writer->Write("/other/image_raw", frame.image_ns, image));
      }
      const CameraInfoMessage info{.header = image.header, .camera = *FindCameraModel("zed_left")};
      EXPECT_TRUE(writer->Write("/cam/camera_info", frame.image_ns, info));
    }
    EXPECT_TRUE(writer->Close());
    Expected<std::unique_ptr<Bag>> bag = OpenBag(path);
    EXPECT_TRUE(bag) << bag.error().message;
    return std::move(*bag);
  }

  ScratchFolder folder_;
  std::vector<Board> boards_;
  std::vector<SensorData> data_;
};

std::vector<Frame> TenthsOfASecond(const std::vector<std::size_t>& data) {
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const std::int64_t stamp = kStart_ns + 100'000'000 * static_cast<std::int64_t>(i);
    frames.push_back({.data = data[i], .cloud_ns = stamp, .image_ns = stamp + 10'000'000});
  }
  return frames;
}

TEST_F(Recording, StillBoardsAreKeptAndMovingOnesLeftOut) {
  Record({0.0, 0.0, 0.07, 0.14, 0.2, 0.2});
  const auto bag = Write(TenthsOfASecond({0, 1, 2, 3, 4, 5}));
  const Expected<BagPlan> plan = PlanBag(*bag, {});
  ASSERT_TRUE(plan) << plan.error().message;
  ASSERT_EQ(plan->moments.size(), 6U);
  EXPECT_EQ(plan->moments[2].difference_ns, 10'000'000);
  ASSERT_TRUE(plan->camera);
  EXPECT_EQ(plan->camera->width_px, 1280);
  const Expected<Observer> observer = Observer::Make(boards_, *plan->camera);
  ASSERT_TRUE(observer) << observer.error().message;
  std::atomic<int> steps = 0;
  const auto views = ObserveBag(*bag, *plan, *observer, [&steps] { ++steps; });
  ASSERT_TRUE(views) << views.error().message;
  ASSERT_EQ(views->size(), 6U);
  EXPECT_EQ((*views)[3].name, "0.300 s");
  EXPECT_EQ(steps, 6);
  const Expected<Assembly> assembly = Assemble(*views, boards_, *plan->camera);
  ASSERT_TRUE(assembly) << assembly.error().message;
  for (const BoardRow& row : assembly->rows) {
    const bool moves = row.view == 2 || row.view == 3;
    EXPECT_EQ(row.fate, moves ? BoardStatus::kLeftOut : BoardStatus::kKept) << row.view << row.why;
    EXPECT_THAT(row.why, HasSubstr(moves ? "it moves" : ""));
  }
}

TEST_F(Recording, StampsThatDoNotMatchAreReportedWithTheirDistance) {
  Record({0.0});
  std::vector<Frame> frames = TenthsOfASecond({0, 0, 0});
  for (Frame& frame : frames) frame.image_ns += 3'200'000'000;
  const auto bag = Write(frames);
  const Expected<BagPlan> plan = PlanBag(*bag, {});
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().code, ErrorCode::kMissingData);
  EXPECT_THAT(plan.error().message, HasSubstr("the time stamps do not match"));
  // From the last scan at 0.2 s to the first image at 3.21 s.
  EXPECT_THAT(plan.error().message, HasSubstr("the nearest are 3.010 s apart"));
}

TEST_F(Recording, OfSeveralTopicsOneMustBeNamed) {
  Record({0.0});
  const auto bag = Write(TenthsOfASecond({0}), true);
  const Expected<BagPlan> several = PlanBag(*bag, {});
  ASSERT_FALSE(several);
  EXPECT_THAT(several.error().message, HasSubstr("--image-topic"));
  EXPECT_THAT(several.error().message, HasSubstr("/other/image_raw with /lidar/points"));
  const Expected<BagPlan> named = PlanBag(*bag, {.image_topic = "/cam/image_raw"});
  EXPECT_TRUE(named) << named.error().message;
  EXPECT_FALSE(PlanBag(*bag, {.image_topic = "/none"}));
}

TEST_F(Recording, OfManyPairsSomeAreTakenEvenly) {
  Record({0.0});
  const auto bag = Write(TenthsOfASecond(std::vector<std::size_t>(9, 0)));
  const Expected<BagPlan> plan = PlanBag(*bag, {.max_views = 3});
  ASSERT_TRUE(plan) << plan.error().message;
  ASSERT_EQ(plan->moments.size(), 3U);
  EXPECT_EQ(plan->moments[0].cloud, 0U);
  EXPECT_EQ(plan->moments[1].cloud, 3U);
  EXPECT_EQ(plan->moments[2].cloud, 6U);
}

TEST_F(Recording, IsCalibratedAsASessionWithItsOwnCamera) {
  Record({0.0, 0.2});
  std::vector<Frame> frames = TenthsOfASecond({0, 1});
  frames[1].cloud_ns += 2'000'000'000;  // Too late to be taken for motion.
  frames[1].image_ns += 2'000'000'000;
  Write(frames);
  const Session session{.bag = folder_.path() / "session.bag"};
  const Expected<Calibration> calibration =
      Calibrate(session, {.boards = boards_, .bootstrap_samples = 0});
  ASSERT_TRUE(calibration) << calibration.error().message;
  ASSERT_TRUE(calibration->result) << calibration->result.error().message;
  EXPECT_EQ(calibration->observed.camera.width_px, 1280);
  EXPECT_EQ(calibration->result->views.size(), 2U);
  EXPECT_NEAR(*calibration->result->views[1].cloud_time_s, 3.1, 1e-9);
  EXPECT_THAT(calibration->result->configuration, testing::Contains("tolerance_s: 0.05"));
  Random random(DeriveSeed(1, "observe_bag", 0, 0));
  const Rigid3d truth = TrueCamFromLidar(TaggedBoards(random));
  EXPECT_LT(DistanceBetween(calibration->result->cam_from_lidar, truth).translation_m, 0.03);

  const Expected<Calibration> unpaired =
      Calibrate(session, {.boards = boards_, .tolerance_s = 0.001});
  ASSERT_FALSE(unpaired);
  EXPECT_THAT(unpaired.error().message, HasSubstr("session.bag: the time stamps do not match"));
}

}  // namespace
}  // namespace sextant::test
