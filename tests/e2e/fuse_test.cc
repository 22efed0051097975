// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

#include "e2e/run_sextant.h"
#include "geometry/rigid3d.h"
#include "io/clouds/cloud_file.h"
#include "io/clouds/pcd_file.h"
#include "support/real_data.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using test::ProgramRun;
using test::RunSextant;
using test::TestPath;
using test::WriteText;
using testing::HasSubstr;

// cam1 is 1 m to the left of cam2 (x to the right); both have the same rotation to the LiDAR.
constexpr const char* kFirst = "0 -1 0 0\n0 0 -1 0\n1 0 0 0\n0 0 0 1\n";
constexpr const char* kSecond = "0 -1 0 -1\n0 0 -1 0\n1 0 0 0\n0 0 0 1\n";

void WriteCloud(const char* name, const std::vector<Eigen::Vector3d>& points) {
  PointCloud cloud;
  cloud.points = points;
  WriteText(TestPath(name), FormatPcd(cloud));
}

void WriteClouds() {
  WriteCloud("a.pcd", {{0.0, 0.0, 2.0}, {0.5, 0.25, 3.0}});
  WriteCloud("b.pcd", {{4.0, 0.0, 2.0}});
  WriteText(TestPath("rts.txt"), std::string(kFirst) + kSecond);
  WriteText(TestPath("one.txt"), kFirst);
  WriteText(TestPath("two.yaml"),
            "version: 9\ncam_from_lidar:\n  translation_m: [-1, 0, 0]\n"
            "  quaternion_wxyz: [0.5, 0.5, -0.5, 0.5]\n  later: 1\n");
}

TEST(Fuse, MovesEveryCloudToTheFrameOfTheLast) {
  WriteClouds();
  const std::string clouds = "fuse " + TestPath("a.pcd") + " " + TestPath("b.pcd");
  const std::string poses[] = {" --rts " + TestPath("rts.txt"),
                               " --from " + TestPath("one.txt") + " --to " + TestPath("two.yaml")};
  for (const std::string& pose : poses) {
    for (const char* out : {"out.pcd", "out.ply"}) {
      const ProgramRun run = RunSextant(clouds + pose + " --out " + TestPath(out));
      ASSERT_EQ(run.exit_code, 0) << run.err;
      EXPECT_THAT(run.out, HasSubstr("3 points of 2 clouds in the frame of " + TestPath("b.pcd")));
      const Expected<PointCloud> fused = ReadCloud(TestPath(out));
      ASSERT_TRUE(fused) << fused.error().message;
      ASSERT_EQ(fused->points.size(), 3U);
      EXPECT_LT((fused->points[0] - Eigen::Vector3d(-1.0, 0.0, 2.0)).norm(), 1e-6);
      EXPECT_LT((fused->points[1] - Eigen::Vector3d(-0.5, 0.25, 3.0)).norm(), 1e-6);
      EXPECT_EQ(fused->points[2], Eigen::Vector3d(4.0, 0.0, 2.0));
    }
  }
}

TEST(Fuse, ReportsWhatIsMissing) {
  WriteClouds();
  const std::string a = TestPath("a.pcd") + " ";
  const std::string b = TestPath("b.pcd") + " ";
  const struct {
    std::string arguments;
    std::string message;
  } cases[] = {
      {a, "expected two clouds"},
      {a + b, "expected a transform for each of the 2 clouds"},
      {a + b + "--from " + TestPath("one.txt"), "expected a transform for each of the 2 clouds"},
      {a + b + a + "--rts " + TestPath("rts.txt"), "expected a transform for each of the 3 clouds"},
      {a + b + "--rts " + TestPath("rts.txt") + " --to " + TestPath("one.txt"),
       "--to has no effect with --rts"},
      {a + b + "--rts " + TestPath("rts.txt") + " --pose-is lidar_from_cam",
       "--pose-is has no effect with --rts"},
      {a + b + "--rts " + TestPath("rts.txt") + " --out x.xyz",
       "expected a name that ends in .ply or .pcd"},
      {a + b + "--rts " + TestPath("nowhere.txt"), "nowhere.txt"},
      {a + TestPath("nowhere.pcd") + " --rts " + TestPath("rts.txt"), "nowhere.pcd"},
  };
  for (const auto& [arguments, message] : cases) {
    const ProgramRun run = RunSextant("fuse " + arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr(message));
  }
}

// The published pose brings more surfaces together, and closer, than none. (Not the median: in both
// scans the ground is at the same height below the sensor, for either pose.)
TEST(Fuse, RealScansAgreeUnderTheirPublishedPose) {
  SEXTANT_REAL_DATA(folder, "gicp");
  WriteText(TestPath("same.txt"), "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const std::string clouds =
      "fuse " + (folder / "source.ply").string() + " " + (folder / "target.ply").string();
  struct Agreement {
    double overlap = 0.0;
    double rms_mm = 0.0;
  };
  const auto fuse = [&](const std::string& to) {
    const ProgramRun run =
        RunSextant(clouds + " --pose-is cam_from_lidar --from " + TestPath("same.txt") + " --to " +
                   to + " --out " + TestPath("out.ply"));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const auto number_after = [&run](const std::string& text) {
      const std::size_t at = run.out.find(text);
      return at == std::string::npos ? -1.0 : std::stod(run.out.substr(at + text.size()));
    };
    return Agreement{number_after("source.ply: "), number_after("rms ")};
  };
  const Agreement published = fuse((folder / "T_target_source.txt").string());
  const Agreement none = fuse(TestPath("same.txt"));
  EXPECT_GT(none.rms_mm, 0.0);
  EXPECT_GT(published.overlap, none.overlap);
  EXPECT_LT(published.rms_mm, none.rms_mm);
}

TEST(Fuse, ReadsTheTransformsOfTheOriginal) {
  SEXTANT_REAL_DATA(folder, "dhall");
  WriteClouds();
  const ProgramRun run =
      RunSextant("fuse " + TestPath("a.pcd") + " " + TestPath("b.pcd") + " --rts " +
                 (folder / "rts.txt").string() + " --out " + TestPath("out.ply"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

}  // namespace
}  // namespace sextant
