// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"
#include "io/poses/pose_file.h"

// The readers of the formats of ReadPoseFile; io/poses/pose_file.h documents them, with their
// bounds in time and memory.
namespace sextant {

/// The pose of one frame in another.
struct FrameTransform {
  std::string parent;
  std::string child;
  Rigid3d parent_from_child;
  int line = 0;
};

/// Whether two statements of one pose agree to 0.001 rad and 0.001 m, as rounded numbers do.
bool Agree(const Rigid3d& a, const Rigid3d& b);

/// The transform between the only LiDAR and the only camera among the frames. `optical_frame`: a
/// frame that the file names as the camera's; may be empty. Errors: kMissingData; kParse where
/// transforms between the two contradict each other.
Expected<StatedPose> ConnectFrames(const std::vector<FrameTransform>& transforms,
                                   const std::string& optical_frame, const std::string& file);

/// The frame of "X is the camera's optical frame", as exports of this program comment; or empty.
std::string OpticalFrameIn(std::string_view text);

/// The upper bound of the cosine between the camera's y axis and the LiDAR's z axis at which a
/// camera is upright, and whether it is in one direction or the other.
inline constexpr double kUprightCosine = -0.7;
bool IsUprightEitherWay(const Rigid3d& pose);

/// The only direction in which the camera is upright; none if that does not decide.
void RecogniseByAxes(StatedPose& pose);

/// A unit quaternion w x y z to 1e-3 and a translation. Error: kParse, of `file` and `line`.
Expected<Rigid3d> PoseOfNumbers(const std::array<double, 3>& translation,
                                const std::array<double, 4>& wxyz, const std::string& file,
                                int line);

/// Numbers of a static_transform_publisher: "x y z qx qy qz qw parent child" or with "yaw pitch
/// roll", or "--x 1 --frame-id base"; quotes, brackets and commas separate too.
Expected<FrameTransform> PublishedTransform(std::string_view arguments, const std::string& file,
                                            int line);

Expected<StatedPose> ParsePoseYaml(std::string_view text, const std::string& file);
/// The camera `name` of the truth of a simulated session; empty: the only one.
Expected<StatedPose> ParsePoseTruth(std::string_view text, const std::string& file,
                                    std::string_view name);
Expected<StatedPose> ParsePoseXml(std::string_view text, const std::string& file);
Expected<StatedPose> ParsePoseLaunch(std::string_view text, const std::string& file);
Expected<StatedPose> ParsePoseKitti(std::string_view text, const std::string& file,
                                    std::string_view name);
Expected<StatedPose> ParsePoseNumbers(std::string_view text, const std::string& file,
                                      std::string_view name);

}  // namespace sextant
