// SPDX-License-Identifier: Apache-2.0
// The covariances of the direct solvers for pixels, against differences by every single pixel.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>

#include "base/random.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/pixel_differences.h"
#include "support/scenes.h"

namespace sextant {
namespace {

using test::CovarianceByPixelDifferences;
using test::MakeScene;
using test::PairScene;
using test::WhitenedDifference;

struct CovarianceCase {
  std::string spec;
  bool planar;
  int pairs;
};

void PrintTo(const CovarianceCase& c, std::ostream* out) { *out << c.spec << ' ' << c.pairs; }

class PnpCovarianceOf : public testing::TestWithParam<CovarianceCase> {
 protected:
  // Sigmas differ from pair to pair, so that mixed-up indices would show.
  static PairScene NoisyScene(const CovarianceCase& c, Random& random) {
    PairScene scene = MakeScene({.pairs = c.pairs, .sigma_px = 0.5, .planar = c.planar}, random);
    for (Pair2d3d& pair : scene.problem.pairs_2d3d) pair.sigma_px = random.Uniform(0.2, 1.0);
    return scene;
  }

  // False where the answer has no derivative. Differences have truncation errors of 1e-10 and
  // rounding errors of 1e-8; the estimators stop up to 1e-9 before their limit, 1e-4 of the
  // displacements.
  static bool DifferencesAgree(const PairScene& scene) {
    const Expected<SolverPtr> solver = BuiltinSolvers().Make(GetParam().spec);
    const Expected<SolveReport> report = (*solver)->Solve(scene.problem);
    EXPECT_TRUE(report && report->covariance);
    if (!report || !report->covariance) return false;
    const auto wanted =
        CovarianceByPixelDifferences(**solver, scene.problem, report->cam_from_lidar);
    if (!wanted) return false;
    EXPECT_LT(WhitenedDifference(*report->covariance, *wanted), 1e-4);
    return true;
  }
};

TEST_P(PnpCovarianceOf, AgreesWithDifferencesOfEveryPixel) {
  Random random(1);
  const int scenes = GetParam().pairs > 100 ? 3 : 10;
  int compared = 0;
  for (int trial = 0; trial < scenes; ++trial) {
    if (DifferencesAgree(NoisyScene(GetParam(), random))) ++compared;
  }
  // epnp of six points has scenes where two candidates fit alike.
  EXPECT_GE(compared, scenes - 1);
}

TEST_P(PnpCovarianceOf, IncludesTheLens) {
  Random random(2);
  int compared = 0;
  for (int trial = 0; trial < 3; ++trial) {
    PairScene scene = NoisyScene(GetParam(), random);
    Camera& camera = *scene.problem.camera;
    camera.model = CameraModel::kBrownConrady;
    camera.distortion = {-0.1, 0.02, 1e-3, -1e-3, 0.0, 0.0, 0.0, 0.0};
    for (Pair2d3d& pair : scene.problem.pairs_2d3d) {
      pair.pixel = *Project(camera, scene.cam_from_lidar * pair.point_in_lidar);
      for (int axis = 0; axis < 2; ++axis) pair.pixel[axis] += pair.sigma_px * random.Normal();
    }
    if (DifferencesAgree(scene)) ++compared;
  }
  EXPECT_GE(compared, 2);
}

// Beyond 84 deg from the axis the kernel works in a rotated view, which depends on the noise: an
// effect of second order.
TEST(PnpCovarianceOfAFisheye, TurnsWithTheView) {
  Random random(3);
  const Rigid3d turned{ExpSo3({0.0, 1.36, 0.0}), Eigen::Vector3d::Zero()};
  for (const char* spec : {"epnp", "sqpnp"}) {
    PairScene scene = MakeScene({.pairs = 20, .sigma_px = 0.1, .extent_m = 0.5}, random);
    Camera& camera = *scene.problem.camera;
    camera.model = CameraModel::kEquidistant;
    camera.width_px = camera.height_px = 0;
    scene.cam_from_lidar = turned * scene.cam_from_lidar;
    bool wide = false;
    for (Pair2d3d& pair : scene.problem.pairs_2d3d) {
      const Eigen::Vector3d in_cam = scene.cam_from_lidar * pair.point_in_lidar;
      ASSERT_TRUE(Project(camera, in_cam));
      pair.pixel = *Project(camera, in_cam);
      for (int axis = 0; axis < 2; ++axis) pair.pixel[axis] += pair.sigma_px * random.Normal();
      wide = wide || in_cam.normalized().z() < 0.1;
    }
    EXPECT_TRUE(wide);
    const Expected<SolverPtr> solver = BuiltinSolvers().Make(spec);
    const Expected<SolveReport> report = (*solver)->Solve(scene.problem);
    ASSERT_TRUE(report && report->covariance) << spec;
    const auto wanted =
        CovarianceByPixelDifferences(**solver, scene.problem, report->cam_from_lidar);
    ASSERT_TRUE(wanted) << spec;
    EXPECT_LT(WhitenedDifference(*report->covariance, *wanted), 1e-2) << spec;
  }
}

std::vector<CovarianceCase> CovarianceCases() {
  std::vector<CovarianceCase> cases;
  for (const int pairs : {6, 9, 20, 200}) {
    for (const char* spec : {"epnp", "sqpnp"}) {
      cases.push_back({spec, false, pairs});
      cases.push_back({spec, true, pairs});
    }
    cases.push_back({"dlt", false, pairs});
    cases.push_back({"ippe", true, pairs});
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(All, PnpCovarianceOf, testing::ValuesIn(CovarianceCases()),
                         [](const auto& test) {
                           const CovarianceCase& c = test.param;
                           return c.spec + (c.planar ? "_plane_" : "_") + std::to_string(c.pairs);
                         });

}  // namespace
}  // namespace sextant
