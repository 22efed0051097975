// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>
#include <vector>

#include "cli/commands.h"
#include "cli/load.h"
#include "cli/progress.h"
#include "cli/session_bag.h"
#include "io/text/text_file.h"
#include "report/image_file.h"
#include "simulator/scene/scene_file.h"
#include "simulator/session/contact_sheet.h"
#include "simulator/session/session.h"

namespace sextant::cli {
namespace {

constexpr const char* kCommand = "simulate";

Expected<SessionOptions> SessionOptionsOf(const SimulateSessionOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const SessionLevel level, FindSessionLevel(options.level));
  SEXTANT_ASSIGN_OR_RETURN(const PcdEncoding encoding, FindPcdEncoding(options.pcd));
  SessionOptions session;
  session.folder = options.out;
  session.level = level;
  session.seed = options.seed;
  session.scans = options.scans;
  session.interval_s = options.interval_s;
  session.ideal = options.ideal;
  session.encoding = encoding;
  session.noise.lidar_sigma_m = options.lidar_sigma_m;
  constexpr double kMarkedByAPerson_px = 3.5;
  constexpr double kFoundInTheImage_px = 1.0;
  const bool is_marked = level == SessionLevel::kPairs;
  session.noise.pixel_sigma_px =
      options.pixel_sigma_px.value_or(is_marked ? kMarkedByAPerson_px : kFoundInTheImage_px);
  session.encode_image = EncodePng;
  return session;
}

Expected<void> WriteSheet(const Scene& scene, const SimulateSessionOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat sheet, DrawContactSheet(scene, options.seed));
  SEXTANT_ASSIGN_OR_RETURN(const std::string bytes, EncodePng(sheet));
  return WriteFileAtomically(options.sheet_path, bytes);
}

Expected<void> WriteExtras(const Scene& scene, const std::vector<ScanTruth>& scans,
                           const SimulateSessionOptions& options) {
  if (options.bag) {
    if (Expected<void> ok = WriteSessionBag(options.out, scene, scans); !ok) return ok;
  }
  return options.sheet_path.empty() ? Expected<void>() : WriteSheet(scene, options);
}

}  // namespace

int RunSimulateSession(const SimulateSessionOptions& options) {
  if (options.scene_path.empty()) {
    return Refuse(kCommand, {ErrorCode::kInvalidOption,
                             "expected a scene file, or the subcommand pairs; scenes are in "
                             "experiments/scenes"});
  }
  const Expected<std::string> text = ReadTextFile(options.scene_path);
  if (!text) return Refuse(kCommand, text.error());
  const Expected<Scene> scene = ParseScene(*text, options.scene_path);
  if (!scene) return Refuse(kCommand, scene.error());
  Expected<SessionOptions> session = SessionOptionsOf(options);
  if (!session) return Refuse(kCommand, session.error());
  if (options.bag) {
    if (const Expected<void> ok = CheckSessionBag(*session); !ok) {
      return Refuse(kCommand, ok.error());
    }
  }
  auto progress = std::make_unique<Progress>("simulating", CountSessionFiles(*scene, *session));
  session->step = [&] { progress->Step(); };
  const Expected<SessionReport> report = SimulateSession(*scene, *text, *session);
  progress.reset();
  if (!report) {
    return Refuse(kCommand,
                  {report.error().code, report.error().code == ErrorCode::kIo
                                            ? report.error().message
                                            : options.scene_path + ": " + report.error().message});
  }
  if (const Expected<void> ok = WriteExtras(*scene, report->scans, options); !ok) {
    return Refuse(kCommand, ok.error());
  }
  fmt::print("{}: scene {}, scans: {}, files written: {}, kept: {}; the truth is in truth.yaml{}\n",
             options.out, scene->name, options.scans, report->written, report->kept,
             options.bag ? ", scans and images also in session.bag" : "");
  return kAnswered;
}

}  // namespace sextant::cli
