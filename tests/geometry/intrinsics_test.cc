// SPDX-License-Identifier: Apache-2.0
#include "geometry/intrinsics.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace sextant {
namespace {

Camera CameraOf(CameraModel model) {
  Camera camera{.model = model, .fx_px = 700.0, .fy_px = 690.0, .cx_px = 640.0, .cy_px = 360.0};
  if (model == CameraModel::kBrownConrady) {
    camera.distortion = {-0.1,  0.02, 1e-3,  -2e-3, 0.003, 0.02, 0.01,
                         0.004, 1e-3, -1e-3, 2e-3,  1e-3,  0.02, -0.03};
    camera.skew_px = 3.0;
  }
  if (model == CameraModel::kOmnidirectional) {
    camera.distortion = {-0.1, 0.02, 1e-3, -2e-3, 0.003};
    camera.xi = 0.9;
  }
  if (model == CameraModel::kDoubleSphere) {
    camera.xi = 0.2;
    camera.alpha = 0.6;
  }
  if (model == CameraModel::kEquidistant) camera.distortion = {0.02, -0.01, 0.003, -0.001};
  return camera;
}

int UsedNumbers(CameraModel model) {
  switch (model) {
    case CameraModel::kPinhole:
    case CameraModel::kDoubleSphere:
      return 4;
    case CameraModel::kEquidistant:
      return 8;
    case CameraModel::kOmnidirectional:
      return 9;
    case CameraModel::kBrownConrady:
      break;
  }
  return kIntrinsicCount;
}

class Intrinsics : public testing::TestWithParam<CameraModel> {};

TEST_P(Intrinsics, VectorHoldsTheWholeCamera) {
  const Camera camera = CameraOf(GetParam());
  Camera other = camera;
  other.fy_px = other.cy_px = 1.0;
  other.distortion[0] += 1.0;
  const Camera back = WithIntrinsics(other, IntrinsicsOf(camera));
  EXPECT_EQ(back.fy_px, camera.fy_px);
  EXPECT_EQ(back.cy_px, camera.cy_px);
  EXPECT_EQ(back.distortion, camera.distortion);
  EXPECT_EQ(IntrinsicName(GetParam(), 1), "fy_px");
  EXPECT_EQ(IntrinsicName(CameraModel::kBrownConrady, 8), "k3");
  EXPECT_EQ(IntrinsicName(CameraModel::kEquidistant, 6), "k3");
}

TEST_P(Intrinsics, AnImageSizeReplacesOnlyTheSize) {
  const Camera camera = CameraOf(GetParam());
  const Camera sized = WithImageSize(camera, 640, 480);
  EXPECT_EQ(sized.width_px, 640);
  EXPECT_EQ(sized.height_px, 480);
  EXPECT_EQ(sized.model, camera.model);
  EXPECT_EQ(IntrinsicsOf(sized), IntrinsicsOf(camera));
  EXPECT_EQ(sized.distortion, camera.distortion);
  EXPECT_EQ(sized.skew_px, camera.skew_px);
  EXPECT_EQ(sized.xi, camera.xi);
  EXPECT_EQ(sized.alpha, camera.alpha);
}

TEST_P(Intrinsics, DerivativeIsThatOfProject) {
  const Camera camera = CameraOf(GetParam());
  const IntrinsicVector numbers = IntrinsicsOf(camera);
  const int used = UsedNumbers(GetParam());
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::Vector3d point;
    for (int i = 0; i < 3; ++i) point[i] = random.Uniform(-1.0, 1.0);
    point.z() += 2.5;
    const auto analytic = PixelByIntrinsics(camera, point);
    ASSERT_TRUE(analytic);
    for (int k = 0; k < used; ++k) {
      const double step = 1e-6 * (1.0 + std::abs(numbers[k]));
      const auto at = [&](double shift) {
        return *Project(WithIntrinsics(camera, numbers + shift * IntrinsicVector::Unit(k)), point);
      };
      const Eigen::Vector2d numeric = (at(step) - at(-step)) / (2.0 * step);
      EXPECT_LT((numeric - analytic->col(k)).norm(), 1e-5) << k;
    }
  }
  EXPECT_FALSE(PixelByIntrinsics(camera, {0.0, 0.0, -1.0}));
}

INSTANTIATE_TEST_SUITE_P(Every, Intrinsics,
                         testing::Values(CameraModel::kPinhole, CameraModel::kBrownConrady,
                                         CameraModel::kEquidistant, CameraModel::kOmnidirectional,
                                         CameraModel::kDoubleSphere));

}  // namespace
}  // namespace sextant
