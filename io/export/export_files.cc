// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <vector>

#include "geometry/so3.h"
#include "io/cameras/camera_parts.h"
#include "io/export/export_texts.h"

namespace sextant {
namespace {

using Rows34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

Eigen::Matrix3d IntrinsicMatrix(const Camera& camera) {
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  k << camera.fx_px, camera.skew_px, camera.cx_px, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 1.0;
  return k;
}

std::string OpenCvMatrix(const char* name, const Eigen::MatrixXd& matrix) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                     name, matrix.rows(), matrix.cols(), NumbersByRow(matrix, ", "));
}

std::string OpenCvCamera(const Camera& camera) {
  const RosDistortion lens = RosDistortionOf(camera);
  std::string text = fmt::format("image_width: {}\nimage_height: {}\ndistortion_model: \"{}\"\n",
                                 camera.width_px, camera.height_px, lens.model);
  if (camera.xi != 0.0) text += fmt::format("xi: {}\n", camera.xi);
  if (camera.alpha != 0.0) text += fmt::format("alpha: {}\n", camera.alpha);
  text += OpenCvMatrix("camera_matrix", IntrinsicMatrix(camera));
  if (lens.coefficients == 0) return text;
  const Eigen::RowVectorXd distortion = Eigen::Map<const Eigen::RowVectorXd>(
      camera.distortion.data(), static_cast<Eigen::Index>(lens.coefficients));
  return text + OpenCvMatrix("distortion_coefficients", distortion);
}

}  // namespace

std::string NumbersByRow(const Eigen::MatrixXd& matrix, const char* between) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) values.push_back(matrix(i, j));
  }
  return fmt::format("{}", fmt::join(values, between));
}

// The comment comes last because some readers count lines, and it contains a colon because others
// split each line at one.
std::string KittiText(const Rigid3d& cam_from_lidar, const Camera& camera) {
  Rows34 projection = Rows34::Zero();
  projection.leftCols<3>() = IntrinsicMatrix(camera);
  const Rows34 tr = cam_from_lidar.Matrix().topRows<3>();
  const std::string p = NumbersByRow(projection, " ");
  std::string text;
  for (int i = 0; i < 4; ++i) text += fmt::format("P{}: {}\n", i, p);
  text += fmt::format("R0_rect: {}\nTr_velo_to_cam: {}\n",
                      NumbersByRow(Eigen::Matrix3d::Identity(), " "), NumbersByRow(tr, " "));
  text += fmt::format("Tr_imu_to_velo: {}\n",
                      NumbersByRow(Eigen::Matrix4d::Identity().topRows<3>(), " "));
  text += "# Tr_velo_to_cam is cam_from_lidar: point_in_cam = Tr_velo_to_cam * point_in_lidar\n";
  if (camera.model != CameraModel::kPinhole) {
    text += "# P0 to P3: for undistorted images with this K\n";
  }
  return text;
}

std::string OpenCvText(const Rigid3d& cam_from_lidar, const Camera* camera) {
  const Eigen::Vector3d rvec = LogSo3(cam_from_lidar.rotation);
  std::string text =
      "%YAML:1.0\n---\n"
      "# point_in_cam = cam_from_lidar * point_in_lidar; metres.\n"
      "# cv::projectPoints(points_in_lidar, rvec_cam_from_lidar, tvec_cam_from_lidar, ...)\n";
  text += OpenCvMatrix("cam_from_lidar", cam_from_lidar.Matrix());
  text += OpenCvMatrix("rvec_cam_from_lidar", rvec);
  text += OpenCvMatrix("tvec_cam_from_lidar", cam_from_lidar.translation);
  if (camera != nullptr) text += OpenCvCamera(*camera);
  return text;
}

std::string MatrixText(const Rigid3d& cam_from_lidar, const std::string& camera_frame,
                       const std::string& lidar_frame) {
  const Eigen::Matrix4d matrix = cam_from_lidar.Matrix();
  std::string text = fmt::format(
      "# cam_from_lidar: point_in_cam = cam_from_lidar * point_in_lidar; metres\n"
      "# camera: {} (x right, y down, z forward), LiDAR: {}\n",
      camera_frame, lidar_frame);
  for (int i = 0; i < 4; ++i) text += NumbersByRow(matrix.row(i), " ") + "\n";
  return text;
}

}  // namespace sextant
