// SPDX-License-Identifier: Apache-2.0
#include "support/calibration_result.h"

#include <limits>

namespace sextant::test {
namespace {

Matrix6d SomeCovariance() {
  Matrix6d covariance = Matrix6d::Identity() * 1e-6;
  covariance(0, 4) = covariance(4, 0) = 1e-6 / 3.0;
  covariance(3, 3) = 5e-324;
  return covariance;
}

ResultView KeptView() {
  ResultView view{.view = 3,
                  .name = "pair \"3\": first",
                  .image_path = "a b/3.png",
                  .cloud_path = "3.pcd",
                  .image_time_s = 1493815925.123456,
                  .cloud_time_s = 1493815925.1};
  view.rmse_m = 0.012;
  view.rmse_px = 1.0 / 3.0;
  view.held_out_m = 0.015;
  view.held_out_px = 0.5;
  view.information = SomeCovariance() * 1e12;
  view.sigma_so_far = SomeCovariance().diagonal().cwiseSqrt();
  view.boards.push_back({.board = 26,
                         .cam_from_board = Rigid3d{ExpSo3({0.1, 0.2, -0.3}), {0.1, -0.2, 1.8}},
                         .lidar_from_board = Rigid3d{ExpSo3({1.1, -1.2, 1.3}), {1.9, 0.1, 1e-17}},
                         .residuals_m = {0.01, 0.02, 0.005, 0.011},
                         .residuals_px = {1.0, 2.0, 0.5, std::numeric_limits<double>::infinity()}});
  return view;
}

TrustFigures SomeTrust() {
  TrustFigures trust;
  trust.folds = 5;
  trust.fit_rmse_m = 0.01;
  trust.held_out_rmse_m = 0.0123;
  trust.bootstrap = BootstrapFigures{.samples = 198, .unanswered = 2};
  trust.bootstrap->low = Vector6d::Constant(-0.01);
  trust.bootstrap->high = Vector6d::Constant(0.02);
  trust.solver_sigma = Vector6d::Constant(1e-3);
  trust.bootstrap_sigma = Vector6d::Constant(1.1e-3);
  trust.jackknife_sigma = Vector6d::Constant(1.2e-3);
  trust.bootstrap_over_solver = 1.1;
  trust.jackknife_over_solver = 1.2;
  trust.stated_over_solver = 1.3;
  trust.outlier_views = {7, 16};
  trust.comparison = "The three agree.";
  return trust;
}

}  // namespace

CalibrationResult FullCalibrationResult() {
  CalibrationResult result;
  result.verdict = ResultVerdict{.usability = Usability::kUsableWithCare,
                                 .reason = "two of 9 views disagree",
                                 .next = "record them again"};
  result.version = "0.1.0";
  result.solver = "joint(gnc(kabsch))";
  result.seed = 0xffffffffffffffffU;
  result.configuration = {"solver: joint(gnc(kabsch))", "extractor: rectangle"};
  result.camera_frame = "camera_optical";
  result.lidar_frame = "velodyne";
  result.cam_from_lidar = {ExpSo3({1.2, -1.2, 1.1}), {0.1, -0.2, 1.0 / 3.0}};
  result.covariance = SomeCovariance();
  result.camera = Camera{.model = CameraModel::kBrownConrady,
                         .width_px = 1280,
                         .height_px = 720,
                         .fx_px = 700.1,
                         .fy_px = 701.0 / 3.0,
                         .cx_px = 640.5,
                         .cy_px = 360.25};
  result.camera->distortion = {-0.1, 0.01, 1e-3, 1.0 / 3.0};
  result.lidar = LidarPattern{.elevations_rad = {-0.2617993877991494, 0.1, 0.26},
                              .azimuth_step_rad = 0.0034906585039886592,
                              .range_sigma_m = 0.01,
                              .aperture_m = 0.0095,
                              .divergence_rad = 0.003};
  result.boards = {
      {.id = 26,
       .top_right_m = 0.468,
       .right_bottom_m = 0.484,
       .name = "left",
       .thickness_m = 0.004,
       .hole = BoardHole{.width_m = 0.2, .height_m = 0.1, .center_in_board_m = {0.1, -0.12}},
       .tags = {{.family = "aruco_original",
                 .id = 26,
                 .edge_m = 0.205,
                 .center_in_board_m = {-0.0815, 0.0995},
                 .rotation_rad = 1.5707963267948966}}},
      {.id = 1,
       .top_right_m = 0.85,
       .right_bottom_m = 0.61,
       .checker = BoardChecker{.inner_columns = 7, .inner_rows = 5, .square_m = 0.095}}};
  result.views.push_back(KeptView());
  result.views.push_back(
      {.view = 7, .name = "7", .kept = false, .reason = "no board in the scan:\nnone of 2"});
  result.trust = SomeTrust();
  result.warnings = {"all boards are parallel", "half of the image is empty"};
  result.closing = "cam_from_lidar maps velodyne to camera_optical, to 1 mm.";
  return result;
}

}  // namespace sextant::test
