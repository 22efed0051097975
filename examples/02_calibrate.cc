// SPDX-License-Identifier: Apache-2.0
// Images and scans of boards -> cam_from_lidar. Usage: 02_calibrate SESSION [RESULT.yaml]
#include <cstdio>
#include <string>
#include <string_view>

#include "calibrate/calibrate.h"
#include "io/output/output_file.h"

int Fail(const sextant::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

int main(int argc, char** argv) {
  if (argc < 2) return std::fputs("usage: 02_calibrate SESSION [RESULT.yaml]\n", stderr), 2;
  // A session file, a folder with one, a folder of `sextant simulate`, or a recording of ROS.
  const auto session = sextant::ReadSession(argv[1]);
  if (!session) return Fail(session.error());

  sextant::CalibrateOptions options;
  options.progress = [](std::string_view stage, std::size_t done, std::size_t total) {
    std::fprintf(stderr, "%s: %zu of %zu\n", std::string(stage).c_str(), done, total);
  };
  const auto calibration = sextant::Calibrate(*session, options);
  if (!calibration) return Fail(calibration.error());                  // Input that is unusable.
  if (!calibration->result) return Fail(calibration->result.error());  // Input without an answer.

  for (const sextant::BoardRow& row : calibration->assembly.rows) {
    std::printf("view %s, board %d: %s %s\n", calibration->observed.views[row.view].name.c_str(),
                row.board, std::string(sextant::ToString(row.fate)).c_str(), row.why.c_str());
  }
  const sextant::CalibrationResult& result = *calibration->result;
  const Eigen::Quaterniond& q = result.cam_from_lidar.rotation;
  const Eigen::Vector3d& t = result.cam_from_lidar.translation;
  std::printf("cam_from_lidar by %s\n", result.solver.c_str());
  std::printf("  quaternion w x y z  %.6f %.6f %.6f %.6f\n", q.w(), q.x(), q.y(), q.z());
  std::printf("  translation x y z   %.4f %.4f %.4f m\n", t.x(), t.y(), t.z());
  for (const std::string& warning : result.warnings) std::printf("%s\n", warning.c_str());
  std::printf("%s\n", result.closing.c_str());
  if (result.verdict) std::printf("%s\n", result.verdict->reason.c_str());

  if (argc < 3) return 0;
  const auto written =
      sextant::WriteFileAtomically(argv[2], sextant::FormatCalibrationResult(result));
  return written ? 0 : Fail(written.error());
}
