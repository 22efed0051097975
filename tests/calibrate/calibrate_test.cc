// SPDX-License-Identifier: Apache-2.0
#include "calibrate/calibrate.h"

#include <gmock/gmock.h>

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "base/units.h"
#include "calibrate/observe/photo_file.h"
#include "eval/extractors/board_scenes.h"
#include "io/clouds/pcd_file.h"
#include "io/output/output_file.h"
#include "report/calibrate_text.h"
#include "simulator/scene/camera_model.h"
#include "solvers/builtin_solvers.h"
#include "support/calibration_scene.h"
#include "support/scratch_folder.h"

namespace sextant::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

// The paper's two boards in a few random places, and the sensors' true pose.
struct SimulatedFrames {
  std::vector<Frame> frames{};
  CalibrateOptions options{};
  Rigid3d cam_from_lidar{};
};

// Place number i, rendered once per process.
struct SimulatedPlace {
  explicit SimulatedPlace(int i) {
    Random random(DeriveSeed(1, "calibrate", 0, static_cast<std::uint64_t>(i)));
    scene = TaggedBoards(random);
    const SensorData data = Record(scene, static_cast<std::uint64_t>(i));
    frame = {"frame " + std::to_string(i), data.image, data.cloud};
  }
  Scene scene{};
  Frame frame{};
};

const SimulatedPlace& PlaceNumber(int i) {
  static std::map<int, SimulatedPlace> places;
  return places.try_emplace(i, i).first->second;
}

SimulatedFrames SimulateFrames(int count) {
  SimulatedFrames simulated;
  for (int i = 0; i < count; ++i) {
    const SimulatedPlace& place = PlaceNumber(i);
    simulated.frames.push_back(place.frame);
    simulated.options.boards = BoardsIn(place.scene);
    simulated.cam_from_lidar = TrueCamFromLidar(place.scene);
  }
  simulated.options.camera = *FindCameraModel("zed_left");
  simulated.options.bootstrap_samples = 20;
  return simulated;
}

std::vector<SolverPtr> Solvers(const std::vector<std::string>& specs) {
  std::vector<SolverPtr> solvers;
  for (const std::string& spec : specs) solvers.push_back(*BuiltinSolvers().Make(spec));
  return solvers;
}

TEST(Calibrate, FramesGiveThePoseAndEveryProductOfThePipeline) {
  SimulatedFrames simulated = SimulateFrames(3);
  std::vector<std::size_t> reported;
  std::mutex mutex;
  simulated.options.progress = [&](std::string_view stage, std::size_t done, std::size_t total) {
    const std::lock_guard lock(mutex);
    if (stage != "views") return;
    EXPECT_EQ(total, 3U);
    reported.push_back(done);
  };
  const Expected<Calibration> calibration = Calibrate(simulated.frames, simulated.options);
  ASSERT_TRUE(calibration) << calibration.error().message;
  ASSERT_TRUE(calibration->result) << calibration->result.error().message;
  const CalibrationResult& result = *calibration->result;

  const PoseDistance error = DistanceBetween(result.cam_from_lidar, simulated.cam_from_lidar);
  EXPECT_LT(error.rotation_rad * kDegPerRad, 0.5);
  EXPECT_LT(error.translation_m, 0.02);
  ASSERT_TRUE(result.covariance);
  EXPECT_EQ(result.solver, DefaultSolver()->spec().name);
  EXPECT_THAT(result.configuration, Contains("solver: " + DefaultSolver()->spec().name));
  EXPECT_THAT(result.configuration, Contains("seed: 1"));
  EXPECT_EQ(result.warnings, calibration->warnings);
  EXPECT_THAT(result.closing, HasSubstr("6 boards in 3 of 3 views"));
  ASSERT_EQ(result.views.size(), 3U);
  for (const ResultView& view : result.views) {
    EXPECT_TRUE(view.kept) << view.reason;
    EXPECT_TRUE(view.information);
    EXPECT_TRUE(view.held_out_m);
  }
  ASSERT_TRUE(calibration->trust);
  EXPECT_EQ(calibration->trust->figures.bootstrap->samples, 20);
  ASSERT_TRUE(result.trust);
  EXPECT_EQ(result.trust->comparison, calibration->trust->figures.comparison);
  ASSERT_TRUE(result.verdict);
  EXPECT_THAT(DescribeCalibration(*calibration),
              testing::StartsWith(std::string(ToString(result.verdict->usability)) + ": "));

  EXPECT_EQ(calibration->observed.views[1].name, "frame 1");
  EXPECT_EQ(calibration->assembly.rows.size(), 6U);
  ASSERT_EQ(calibration->comparison.size(), 1U);
  EXPECT_EQ(calibration->report(), &*calibration->comparison[0].report);
  EXPECT_EQ(reported.front(), 0U);
  EXPECT_EQ(reported.back(), 3U);
  const std::string text = DescribeCalibration(*calibration);
  for (const char* part : {"frame 2", "kept", "1 sigma, along x y z", "It rests on"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST(Calibrate, TheFirstSolverGivesTheResultAndTheOthersAreCompared) {
  SimulatedFrames simulated = SimulateFrames(1);
  simulated.options.solvers = Solvers({"kabsch", "epnp"});
  simulated.options.bootstrap_samples = 0;
  const Expected<Calibration> calibration = Calibrate(simulated.frames, simulated.options);
  ASSERT_TRUE(calibration) << calibration.error().message;
  ASSERT_TRUE(calibration->result) << calibration->result.error().message;
  EXPECT_EQ(calibration->result->solver, "kabsch");
  ASSERT_EQ(calibration->comparison.size(), 2U);
  EXPECT_EQ(calibration->comparison[1].solver, "epnp");
  EXPECT_TRUE(calibration->comparison[1].from_first);
  EXPECT_FALSE(calibration->comparison[0].from_truth);
  EXPECT_FALSE(calibration->trust);
  EXPECT_FALSE(calibration->result->trust);
  EXPECT_THAT(calibration->warnings, Contains(HasSubstr("one view only")));
  EXPECT_THAT(DescribeCalibration(*calibration), HasSubstr("to first"));
}

TEST(Calibrate, ASessionOfFilesGivesTheSameAsItsFramesInMemory) {
  const SimulatedFrames simulated = SimulateFrames(2);
  const ScratchFolder folder;
  Session session{.true_cam_from_lidar = simulated.cam_from_lidar};
  for (std::size_t i = 0; i < simulated.frames.size(); ++i) {
    const std::string number = std::to_string(i);
    const FilePair pair{.name = number,
                        .image = folder.path() / ("photo" + number + ".png"),
                        .cloud = folder.path() / ("scan" + number + ".pcd")};
    ASSERT_TRUE(WriteImage(simulated.frames[i].image, pair.image));
    ASSERT_TRUE(WriteFileAtomically(pair.cloud, FormatPcd(simulated.frames[i].cloud)));
    session.files.pairs.push_back(pair);
  }
  session.files.pairs.push_back({.name = "lost", .image = folder.path() / "no.png"});
  session.files.without_partner = {"lonely.png"};
  const Expected<Calibration> calibration = Calibrate(session, simulated.options);
  ASSERT_TRUE(calibration) << calibration.error().message;
  ASSERT_TRUE(calibration->result) << calibration->result.error().message;
  const Expected<Calibration> in_memory = Calibrate(simulated.frames, simulated.options);
  ASSERT_TRUE(in_memory && in_memory->result);
  const PoseDistance apart =
      DistanceBetween(calibration->result->cam_from_lidar, in_memory->result->cam_from_lidar);
  EXPECT_LT(apart.translation_m, 1e-4);  // PCD files have single precision.
  EXPECT_LT(apart.rotation_rad, 1e-4);

  ASSERT_TRUE(calibration->comparison.front().from_truth);
  EXPECT_LT(calibration->comparison.front().from_truth->translation_m, 0.02);
  EXPECT_THAT(DescribeCalibration(*calibration), HasSubstr("error against the truth"));
  EXPECT_EQ(calibration->assembly.rows.back().fate, BoardStatus::kUnreadable);
  EXPECT_THAT(calibration->assembly.rows.back().why, HasSubstr("no.png"));
  EXPECT_THAT(calibration->warnings, Contains("without a partner: lonely.png"));
  const ProblemFile problem = ProblemFileOf(*calibration);
  ASSERT_TRUE(problem.true_cam_from_lidar);
  EXPECT_EQ(problem.problem.board_views.size(), 4U);
  EXPECT_THAT(problem.comment, HasSubstr("4 boards in 3 views"));
}

TEST(Calibrate, WithoutACommonBoardTheViewsAreThereAndTheResultSaysWhy) {
  SimulatedFrames simulated = SimulateFrames(1);
  for (Board& board : simulated.options.boards) board.tags[0].id += 1;
  const Expected<Calibration> calibration = Calibrate(simulated.frames, simulated.options);
  ASSERT_TRUE(calibration) << calibration.error().message;
  ASSERT_FALSE(calibration->result);
  EXPECT_EQ(calibration->result.error().code, ErrorCode::kMissingData);
  EXPECT_THAT(calibration->result.error().message, HasSubstr("no board was seen by both sensors"));
  ASSERT_EQ(calibration->observed.views.size(), 1U);
  EXPECT_EQ(calibration->observed.views[0].seen->in_scan.size(), 2U);
  EXPECT_EQ(calibration->report(), nullptr);
  EXPECT_EQ(DescribeCalibration(*calibration), "");
}

TEST(Calibrate, ASolverWithoutAnAnswerLeavesTheAssemblyAndTheWarnings) {
  SimulatedFrames simulated = SimulateFrames(1);
  simulated.options.boards.resize(1);
  simulated.options.solvers = Solvers({"dlt", "kabsch"});
  const Expected<Calibration> calibration = Calibrate(simulated.frames, simulated.options);
  ASSERT_TRUE(calibration) << calibration.error().message;
  ASSERT_FALSE(calibration->result);
  EXPECT_EQ(calibration->result.error().code, ErrorCode::kTooFewPairs);
  EXPECT_EQ(calibration->assembly.problem.pairs_3d3d.size(), 4U);
  EXPECT_TRUE(calibration->comparison[1].report);
  EXPECT_THAT(calibration->warnings, Contains(HasSubstr("one view only")));
  const std::string text = DescribeCalibration(*calibration);
  EXPECT_THAT(text, HasSubstr("kept"));
  EXPECT_THAT(text, HasSubstr("one view only"));
}

TEST(Calibrate, ThePoseOfTheOptionsComesBeforeThatOfTheSession) {
  const SimulatedFrames simulated = SimulateFrames(1);
  Expected<ObservedSession> observed = ObserveFrames(simulated.frames, simulated.options);
  ASSERT_TRUE(observed) << observed.error().message;
  observed->session.initial_cam_from_lidar =
      Rigid3d{Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), Eigen::Vector3d::Zero()};
  CalibrateOptions options = simulated.options;
  options.bootstrap_samples = 0;
  const Calibration by_session = CalibrateObserved(*observed, options);
  ASSERT_TRUE(by_session.result);
  EXPECT_THAT(by_session.result->configuration,
              Contains("initial_quaternion_wxyz: 0.5 0.5 -0.5 0.5"));
  options.match.initial = simulated.cam_from_lidar;
  options.search_description = {"lidar: mine"};
  const Calibration by_options = CalibrateObserved(*observed, options);
  ASSERT_TRUE(by_options.result);
  EXPECT_THAT(by_options.result->configuration,
              testing::Not(Contains("initial_quaternion_wxyz: 0.5 0.5 -0.5 0.5")));
  EXPECT_THAT(by_options.result->configuration, Contains("lidar: mine"));
}

TEST(Calibrate, InputThatCannotBeUsedIsAnError) {
  const SimulatedFrames simulated = SimulateFrames(1);
  EXPECT_FALSE(Calibrate(simulated.frames, {}));
  EXPECT_FALSE(Calibrate(std::vector<Frame>(), simulated.options));
  const auto message = [](const Session& session, const CalibrateOptions& options) {
    const Expected<Calibration> calibration = Calibrate(session, options);
    return calibration ? "none" : calibration.error().message;
  };
  EXPECT_THAT(message({}, {}), HasSubstr("boards are missing"));
  EXPECT_THAT(message({}, {.boards = simulated.options.boards}), HasSubstr("camera is missing"));
  EXPECT_THAT(message({}, simulated.options), HasSubstr("no image has a scan"));
  EXPECT_THAT(message({.boards = "/nowhere/boards.yaml"}, {}), HasSubstr("/nowhere/boards.yaml"));
  EXPECT_THAT(message({.bag = "/nowhere/a.bag"}, simulated.options), HasSubstr("/nowhere/a.bag"));
}

}  // namespace
}  // namespace sextant::test
