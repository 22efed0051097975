// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cmath>

#include "base/units.h"
#include "base/version.h"
#include "calibrate/scene/pose_check.h"
#include "calibrate/trust/verdict.h"
#include "cli/commands/commands.h"
#include "cli/need_option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/scene_input.h"
#include "geometry/symmetric.h"
#include "io/output/output_file.h"
#include "io/text/number_text.h"

namespace sextant::cli {
namespace {

struct RefineSceneOptions {
  SceneInputOptions input{};
  std::vector<double> need = {50.0, 0.25};  ///< mm and degrees.
  std::string out_path = "result.yaml";
  std::string json_path{};
};

void Declare(RefineSceneOptions& options, Arguments& arguments) {
  DeclareSceneInput(options.input, arguments);
  DeclareNeed(options.need, arguments);
  arguments.Add("--out", options.out_path, "Result file (YAML)",
                {.shows_default = true, .writes = Writes::kFile});
  arguments.Add("--json", options.json_path, "Write the result as JSON too; - for standard output",
                {.writes = Writes::kFileOrStandardOutput});
}

double WorstSigma(const SquareMatrix<3>& covariance) {
  return std::sqrt(EigenOf<3>(covariance).values(2));
}

// A fit whose edges coincide by chance is not usable whatever its covariance. Scenes are never
// GOOD: no independent measurement, as a board is, confirms them.
ResultVerdict VerdictOf(const SceneFit& fit, const Rigid3d& start,
                        const RefineSceneOptions& options) {
  // A start off by the whole limit is refined, too, to a pose that is a little farther from it.
  constexpr double kMargin = 1.25;
  const PoseDistance moved = DistanceBetween(fit.cam_from_lidar, start);
  if (moved.rotation_rad > kMargin * kSearchedRotation_rad ||
      moved.translation_m > kMargin * kSearchedTranslation_m) {
    return {.usability = Usability::kNotUsable,
            .reason = fmt::format("the refined pose is more than {:.3f} m or {:.1f} deg from the "
                                  "start, the limit of the search, and may be a wrong optimum",
                                  kMargin * kSearchedTranslation_m,
                                  kMargin * kSearchedRotation_rad / kRadPerDeg),
            .next = "Look at it with sextant project; where the edges coincide, start from it"};
  }
  const double rotation_deg = WorstSigma(fit.covariance.topLeftCorner<3, 3>()) / kRadPerDeg;
  const double translation_mm = 1e3 * WorstSigma(fit.covariance.bottomRightCorner<3, 3>());
  const std::string accuracy = fmt::format(
      "1 sigma of the least certain direction is {:.0f} mm and {:.2f} deg, needed are "
      "{:.0f} mm and {:.2f} deg",
      translation_mm, rotation_deg, options.need[0], options.need[1]);
  const std::string unclear = WhyUnclear(fit);
  const bool is_enough = translation_mm <= options.need[0] && rotation_deg <= options.need[1];
  if (unclear.empty() && is_enough) {
    return {.usability = Usability::kUsableWithCare,
            .reason = accuracy,
            .next = "Look at it with sextant project; a board gives a better one"};
  }
  return {.usability = Usability::kNotUsable,
          .reason = unclear.empty() ? accuracy : unclear,
          .next = "Add pairs of scenes that differ, with objects near and far"};
}

CalibrationResult ResultOf(const SceneInput& input, const SceneFit& fit,
                           const RefineSceneOptions& options) {
  const ResultVerdict verdict = VerdictOf(fit, input.given.cam_from_lidar, options);
  CalibrationResult result;
  result.version = std::string(Version());
  result.solver = "scene_edges";
  result.configuration = {fmt::format("pairs: {}", input.session.files.pairs.size()),
                          fmt::format("depth edges: {}", fit.edges)};
  result.verdict = verdict;
  result.camera_frame = input.given.camera_frame;
  result.lidar_frame = input.given.lidar_frame;
  result.cam_from_lidar = fit.cam_from_lidar;
  result.covariance = fit.covariance;
  result.camera = input.given.camera;
  result.closing = fmt::format("cam_from_lidar by the edges of {} everyday scenes. {}", fit.scenes,
                               verdict.reason);
  return result;
}

std::string Describe(const CalibrationResult& result, const SceneInput& input) {
  const Vector6d change = PoseDifference(result.cam_from_lidar, input.given.cam_from_lidar);
  const Vector6d sigma = result.covariance->diagonal().cwiseSqrt();
  const Eigen::Vector3d& t = result.cam_from_lidar.translation;
  std::string text = fmt::format("{}: {}. {}.\n\ncam_from_lidar: t ({:.4f}, {:.4f}, {:.4f}) m\n",
                                 ToString(result.verdict->usability), result.verdict->reason,
                                 result.verdict->next, t.x(), t.y(), t.z());
  text += "changed by, with 1 sigma:\n";
  for (int i = 0; i < 3; ++i) {
    text += fmt::format("  {}: {:7.3f} +- {:.3f} deg {:7.1f} +- {:.1f} mm\n", "xyz"[i],
                        change(i) / kRadPerDeg, sigma(i) / kRadPerDeg, 1e3 * change(3 + i),
                        1e3 * sigma(3 + i));
  }
  return text;
}

int Run(const RefineSceneOptions& options) {
  const Expected<SceneInput> input = ReadSceneInput(options.input);
  if (!input) return Refuse("refine-scene", input.error());
  Progress progress;
  const Expected<std::vector<ScenePair>> pairs = ReadScenePairs(*input, progress.Callback());
  if (!pairs) return Refuse("refine-scene", pairs.error());
  const SceneFit fit = SearchScenes(*pairs, input->given.cam_from_lidar, progress.Callback());
  const CalibrationResult result = ResultOf(*input, fit, options);
  std::string text = Describe(result, *input);
  const Expected<void> written =
      WriteFileAtomically(options.out_path, FormatCalibrationResult(result));
  if (written) text += WroteLine(options.out_path, "the result, for project and export");
  const int code =
      Deliver("refine-scene", options.json_path, text, FormatCalibrationResultJson(result),
              result.verdict->usability == Usability::kNotUsable ? kNotUsable : kAnswered);
  return written ? code : Refuse("refine-scene", written.error());
}

}  // namespace

Command RefineSceneCommand() {
  constexpr const char* kFooter =
      "The start may be off by 2 deg and 10 cm. A result that is NOT USABLE is written too, with "
      "exit\n"
      "code 3. docs/check.md has the method and what limits it.\n"
      "Example:\n"
      "  sextant refine-scene rough.txt --camera cam.yaml --image 'cam/*.png' --cloud 'scan/*.pcd' "
      "--out result.yaml";
  return MakeCommand<RefineSceneOptions>(
      "refine-scene", "A rough cam_from_lidar refined with everyday scenes, without a board",
      kFooter, Declare, Run);
}

}  // namespace sextant::cli
