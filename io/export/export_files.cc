// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "geometry/intrinsics.h"
#include "geometry/so3.h"
#include "io/export/export_texts.h"

namespace sextant {
namespace {

using Rows34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

template <class Matrix>
std::string Numbers(const Matrix& matrix, const char* between) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) values.push_back(matrix(i, j));
  }
  return fmt::format("{}", fmt::join(values, between));
}

Eigen::Matrix3d IntrinsicMatrix(const Camera& camera) {
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  k << camera.fx_px, camera.skew_px, camera.cx_px, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 1.0;
  return k;
}

template <class Matrix>
std::string OpenCvMatrix(const char* name, const Matrix& matrix) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                     name, matrix.rows(), matrix.cols(), Numbers(matrix, ", "));
}

std::string OpenCvCamera(const Camera& camera) {
  const bool fisheye = camera.model == CameraModel::kEquidistant;
  const std::span<const double> written = WrittenDistortion(camera);
  const auto count = fisheye ? 4 : static_cast<Eigen::Index>(written.size());
  const Eigen::RowVectorXd distortion = Eigen::Map<const Eigen::RowVectorXd>(written.data(), count);
  return fmt::format("image_width: {}\nimage_height: {}\ndistortion_model: \"{}\"\n",
                     camera.width_px, camera.height_px,
                     fisheye ? "fisheye" : "plumb_bob_or_rational") +
         OpenCvMatrix("camera_matrix", IntrinsicMatrix(camera)) +
         OpenCvMatrix("distortion_coefficients", distortion);
}

}  // namespace

// The comment comes last because some readers count lines, and it contains a colon because others
// split each line at one.
std::string KittiText(const Rigid3d& cam_from_lidar, const Camera& camera) {
  Rows34 projection = Rows34::Zero();
  projection.leftCols<3>() = IntrinsicMatrix(camera);
  const Rows34 tr = cam_from_lidar.Matrix().topRows<3>();
  const std::string p = Numbers(projection, " ");
  std::string text;
  for (int i = 0; i < 4; ++i) text += fmt::format("P{}: {}\n", i, p);
  text += fmt::format("R0_rect: {}\nTr_velo_to_cam: {}\n",
                      Numbers(Eigen::Matrix3d::Identity(), " "), Numbers(tr, " "));
  text += fmt::format("Tr_imu_to_velo: {}\n",
                      Numbers(Rows34(Eigen::Matrix4d::Identity().topRows<3>()), " "));
  const bool distorted = std::any_of(camera.distortion.begin(), camera.distortion.end(),
                                     [](double value) { return value != 0.0; });
  text += "# Tr_velo_to_cam is cam_from_lidar: point_in_cam = Tr_velo_to_cam * point_in_lidar\n";
  if (distorted) text += "# P0 to P3: for undistorted images with this K\n";
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
  for (int i = 0; i < 4; ++i) text += Numbers(Eigen::RowVector4d(matrix.row(i)), " ") + "\n";
  return text;
}

}  // namespace sextant
