// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/diagnose.h"

#include <gmock/gmock.h>

#include "calibrate/trust/scale_fit.h"
#include "geometry/scan_marks.h"
#include "support/fake_observation.h"

namespace sextant::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

struct FakedSession {
  std::vector<SessionView> views;
  std::vector<Board> boards = {SquareBoard(0)};
  Camera camera = AssumedCamera(1280, 720);
};

// What the camera sees is moved from where the board is by `disturb`.
template <class Disturb>
FakedSession FakeSession(int views, Disturb disturb) {
  Random random(DeriveSeed(1, "diagnose", 0, 0));
  FakedSession faked;
  for (int i = 0; i < views; ++i) {
    const std::vector<Rigid3d> poses = {PlacedAtRandom(random)};
    SessionView view{.name = std::to_string(i)};
    view.seen = FakeObservation(faked.boards, poses, kFakeCamFromLidar, random);
    CameraSighting& sighting = view.seen->in_image[0];
    disturb(sighting.pose.cam_from_board.translation);
    sighting.corners.points.clear();
    for (const Eigen::Vector3d& corner : BoardCorners(faked.boards[0])) {
      sighting.corners.points.push_back(sighting.pose.cam_from_board * corner);
    }
    faked.views.push_back(std::move(view));
  }
  return faked;
}

std::vector<std::string> DiagnoseIt(const FakedSession& faked) {
  const Expected<Assembly> assembly = Assemble(faked.views, faked.boards, faked.camera);
  EXPECT_TRUE(assembly) << assembly.error().message;
  return Diagnose(faked.views, *assembly, assembly->matching.cam_from_lidar);
}

TEST(Diagnose, GoodDataIsNotBlamed) {
  EXPECT_THAT(DiagnoseIt(FakeSession(8, [](Eigen::Vector3d&) {})), IsEmpty());
}

TEST(Diagnose, APrintThatIsSmallerThanTheFileSays) {
  const FakedSession faked = FakeSession(8, [](Eigen::Vector3d& place) { place *= 1.06; });
  const std::vector<std::string> lines = DiagnoseIt(faked);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_THAT(lines[0], HasSubstr("board file"));
  EXPECT_THAT(lines[0], HasSubstr("the print is smaller"));
}

TEST(Diagnose, AFocalLengthThatIsTooShort) {
  const FakedSession faked = FakeSession(8, [](Eigen::Vector3d& place) { place.z() *= 0.92; });
  const std::vector<std::string> lines = DiagnoseIt(faked);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_THAT(lines[0], HasSubstr("intrinsics"));
  EXPECT_THAT(lines[0], HasSubstr("too short"));
}

TEST(Diagnose, TheShareOfBothIsRight) {
  const FakedSession faked = FakeSession(12, [](Eigen::Vector3d& place) { place *= 1.05; });
  const Expected<Assembly> assembly = Assemble(faked.views, faked.boards, faked.camera);
  ASSERT_TRUE(assembly);
  const auto fits = FitScales(assembly->problem, assembly->matching.cam_from_lidar);
  ASSERT_TRUE(fits);
  EXPECT_NEAR(fits->print.excess, 0.05, 5.0 * fits->print.sigma);
  // Corners of 7 mm an axis between the sensors, 12 boards spread over 1.6 m.
  EXPECT_LT(fits->print.sigma, 0.01);
}

TEST(Diagnose, ABoardOfAnotherSizeInTheScans) {
  FakedSession faked = FakeSession(4, [](Eigen::Vector3d&) {});
  for (SessionView& view : faked.views) {
    view.seen->in_scan[0].measured_sides_m = {0.55, 0.5, 0.56, 0.5};
  }
  const std::vector<std::string> lines = DiagnoseIt(faked);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_THAT(
      lines[0],
      HasSubstr("measures 0.555 m from top to right in the scans, the file states 0.500 m"));
}

TEST(Diagnose, PrintsThatTheLensDoesNotFit) {
  FakedSession faked = FakeSession(4, [](Eigen::Vector3d&) {});
  for (SessionView& view : faked.views) {
    BoardPose& pose = view.seen->in_image[0].pose;
    pose.rms_px = 2.5;
    pose.residuals = 70;
    pose.chi_square = 64.0 * 400.0;
  }
  const std::vector<std::string> lines = DiagnoseIt(faked);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_THAT(lines[0], HasSubstr("only to 2.5 px, 20 times their noise"));
}

TEST(Diagnose, OneViewAndViewsThatRepeatEachOther) {
  EXPECT_THAT(DiagnoseIt(FakeSession(1, [](Eigen::Vector3d&) {})),
              testing::ElementsAre(HasSubstr("one view only")));
  Random random(3);
  FakedSession same;
  const std::vector<Rigid3d> poses = {PlacedAtRandom(random)};
  for (int i = 0; i < 3; ++i) {
    SessionView view{.name = "same"};
    view.seen = FakeObservation(same.boards, poses, kFakeCamFromLidar, random);
    same.views.push_back(std::move(view));
  }
  EXPECT_THAT(DiagnoseIt(same), testing::Contains(HasSubstr("all 3 views are the same")));
}

}  // namespace
}  // namespace sextant::test
