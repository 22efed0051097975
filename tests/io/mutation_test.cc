// SPDX-License-Identifier: Apache-2.0
// Every reader survives any damage to a valid file: it reads it or refuses it in one line.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/random.h"
#include "io/boards/board_file.h"
#include "io/boards/marker_files.h"
#include "io/boards/polygon_file.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/csv_cloud.h"
#include "io/clouds/pcd_file.h"
#include "io/clouds/ply_file.h"
#include "io/original/average_log.h"
#include "io/original/original_config.h"
#include "io/problems/acfr_poses.h"
#include "io/problems/pairs_csv.h"
#include "io/problems/points_file.h"
#include "io/problems/read_problem.h"
#include "io/problems/transform_list.h"
#include "io/results/calibration_result.h"
#include "io/results/results_json.h"
#include "support/bad_text.h"
#include "support/calibration_result.h"
#include "support/scenes.h"

namespace sextant {
namespace {

using test::Repeated;

/// The error message of a reader; empty if it accepts the text.
using Refusal = std::function<std::string(const std::string&)>;

template <class T>
Refusal RefusalOf(Expected<T> (*parse)(std::string_view, const std::string&)) {
  return [parse](const std::string& text) {
    const Expected<T> read = parse(text, "f");
    if (!read) return read.error().message;
    return std::string();
  };
}

struct Reader {
  const char* name;
  std::string good;
  Refusal refusal;
};

void PrintTo(const Reader& reader, std::ostream* out) { *out << reader.name; }

CalibrationProblem SomeProblem() {
  Random random(1);
  return test::MakeScene({.pairs = 4, .sigma_m = 0.01, .sigma_px = 0.5}, random).problem;
}

PointCloud SomeCloud() {
  PointCloud cloud;
  for (int i = 0; i < 20; ++i) {
    cloud.points.emplace_back(i, 0.1 * i, -i);
    cloud.intensity.push_back(7.0F);
    cloud.ring.push_back(static_cast<std::uint16_t>(i));
  }
  return cloud;
}

std::vector<Reader> Readers() {
  const CalibrationProblem problem = SomeProblem();
  ResultFile results;
  results.results.push_back({"kabsch", SolveReport{}});
  results.results.push_back({"p3p", MakeError(ErrorCode::kDegenerate, "on a line")});
  const std::string identity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  return {
      {"Yaml", FormatProblemYaml({problem, Rigid3d{}, "made"}), RefusalOf(ParseProblemYaml)},
      {"Points", FormatPoints(problem.pairs_3d3d), RefusalOf(ParsePoints)},
      {"CsvPixels", FormatPairsCsv(problem.pairs_2d3d), RefusalOf(ParsePairsCsv)},
      {"CsvPoints", FormatPairsCsv(problem.pairs_3d3d), RefusalOf(ParsePairsCsv)},
      {"AnyProblem", FormatPoints(problem.pairs_3d3d), RefusalOf(ParseProblem)},
      {"Results", FormatResults(results), RefusalOf(ParseResults)},
      {"AverageLog", "1\n0.5\n0\n0\n1 0 0\n0 1 0\n0 0 1\n0.1\n", RefusalOf(ParseAverageLog)},
      {"Config", Repeated("1 2\n", 4) + "0.1\n2\n0\n" + Repeated("1 0 0 0\n", 3) + "9\n1 2 3\n",
       RefusalOf(ParseOriginalConfig)},
      {"Markers", "1\n48.4\n46.8\n4.0\n5.0\n20.5\n", RefusalOf(ParseMarkerCoordinates)},
      {"Detected", "26=(573.6,220.9) (515,274) (461,216) (520,163) Txyz=0 0 1 Rxyz=1 2 3\n",
       RefusalOf(ParseDetectedMarkers)},
      {"Transforms", identity + "\n" + identity, RefusalOf(ParseTransformList)},
      {"CameraYaml",
       "%YAML:1.0\n---\nimage_width: 640\ncamera_matrix: !!opencv-matrix\n  rows: 3\n  data: [600, "
       "0, 320, 0, 600, 240, 0, 0, 1]\nD: [0.1, 0, 0, 0]\n",
       RefusalOf(ParseCamera)},
      {"CameraIni",
       "[image]\n\nwidth\n640\n\n[camera]\ncamera matrix\n600 0 320\n0 600 240\n0 0 "
       "1\n\ndistortion\n0 0 0 "
       "0 0\n",
       RefusalOf(ParseCamera)},
      {"Boards",
       "boards:\n  - id: 0\n    top_right_m: 0.6\n    right_bottom_m: 0.8\n    hole: {width_m: "
       "0.1, height_m: 0.1}\n    tags:\n      - {family: a, id: 1, edge_m: 0.1, "
       "center_in_board_m: [0.2, 0.2]}\n",
       RefusalOf(ParseBoards)},
      {"PcdAscii", FormatPcd(SomeCloud(), PcdEncoding::kAscii), RefusalOf(ParsePcd)},
      {"PcdBinary", FormatPcd(SomeCloud(), PcdEncoding::kBinary), RefusalOf(ParsePcd)},
      {"PcdCompressed", FormatPcd(SomeCloud(), PcdEncoding::kBinaryCompressed),
       RefusalOf(ParsePcd)},
      {"Polygons",
       "sextant_polygons: 1\ncamera: {model: pinhole, fx_px: 1, fy_px: 1, cx_px: 0, cy_px: 0}\n"
       "cam_from_lidar:\n  translation_m: [0, 0, 0]\n  quaternion_wxyz: [1, 0, 0, 0]\n"
       "boards:\n  - id: 0\n    edges:\n      - [[0, 0], [1, 0], [1, 1], [0, 1]]\n"
       "corners:\n  - {board: 0, corner: 1, pixel: [1, 2]}\nunfinished:\n  - [1, 2]\n",
       RefusalOf(ParsePolygons)},
      {"AcfrPoses",
       Repeated("1,2,3\n", 2) + "1,0,4\n2,0,4\n2,1,4\n1,1,4\n" + Repeated("1,2,3\n", 2) +
           "4,1,0\n4,2,0\n4,2,1\n4,1,1\n" + Repeated("1,0,0\n", 7),
       RefusalOf(ParseAcfrPoses)},
      {"CalibrationResult", FormatCalibrationResult(test::FullCalibrationResult()),
       RefusalOf(ParseCalibrationResult)},
      {"CalibrationResultJson", FormatCalibrationResultJson(test::FullCalibrationResult()),
       RefusalOf(ParseCalibrationResult)},
      {"CsvCloud", "x,y,z,ring\n" + Repeated("1.25,2.25,3.25,4\n", 4), RefusalOf(ParseCsvCloud)},
      {"Ply",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
       "float z\nend_header\n" +
           Repeated("1.25 2.25 3.25\n", 4),
       RefusalOf(ParsePly)},
  };
}

// Cuts, duplicates or overwrites a part of the text.
std::string Damaged(std::string text, Random& random) {
  static const std::string kPieces[] = {"",
                                        "\n",
                                        ":",
                                        ",",
                                        "-",
                                        "nan",
                                        "1e999",
                                        "[",
                                        "{",
                                        "(",
                                        "\"",
                                        "&a ",
                                        "*a",
                                        "\t",
                                        "99999999999",
                                        "%",
                                        "#",
                                        "|",
                                        "? ",
                                        "<<",
                                        "\r",
                                        std::string(1, '\0'),
                                        "\xff",
                                        "!!"};
  const std::uint64_t edits = 1 + random.Below(3);
  for (std::uint64_t i = 0; i < edits && !text.empty(); ++i) {
    const std::uint64_t at = random.Below(text.size());
    const std::uint64_t length = random.Below(2) == 0 ? random.Below(3) : random.Below(40);
    const std::string stretch = text.substr(at, length);
    const std::uint64_t piece = random.Below(std::size(kPieces));
    text.replace(at, length, random.Below(4) == 0 ? stretch + stretch : kPieces[piece]);
  }
  return text;
}

class MutationTest : public testing::TestWithParam<Reader> {};

TEST_P(MutationTest, ReadsOrRefusesEveryDamage) {
  const Reader& reader = GetParam();
  EXPECT_EQ(reader.refusal(reader.good), "");
  Random random(2);
  int refused = 0;
  constexpr int kTrials = 100;
  for (int trial = 0; trial < kTrials; ++trial) {
    const std::string message = reader.refusal(Damaged(reader.good, random));
    if (message.empty()) continue;
    ++refused;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_LT(message.size(), 500U) << message;
    EXPECT_TRUE(message.starts_with("f:")) << message;
  }
  // Damage within a number or a comment may leave a valid file, but rarely.
  EXPECT_GT(refused, kTrials / 4);
}

TEST_P(MutationTest, ReadsOrRefusesEveryTruncation) {
  const Reader& reader = GetParam();
  const std::size_t step = 1 + reader.good.size() / 200;
  for (std::size_t size = 0; size < reader.good.size(); size += step) {
    const std::string message = reader.refusal(reader.good.substr(0, size));
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, MutationTest, testing::ValuesIn(Readers()),
                         [](const auto& reader) { return reader.param.name; });

}  // namespace
}  // namespace sextant
