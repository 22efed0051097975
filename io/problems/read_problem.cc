// SPDX-License-Identifier: Apache-2.0
#include "io/problems/read_problem.h"

#include <fmt/format.h>

#include <optional>

#include "io/problems/acfr_poses.h"
#include "io/problems/csv_header.h"
#include "io/problems/pairs_csv.h"
#include "io/problems/points_file.h"
#include "io/problems/problem_range.h"
#include "io/text/line_reader.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

bool IsNumber(std::string_view text) { return ParseFinite(text, {}).has_value(); }

// Whether this is avg_values.txt of the original package: its first four lines hold one number
// each, whereas points.txt has a count and then points.
bool IsAverageLog(std::string_view text, const std::string& file) {
  LineReader in(file, text);
  for (int line = 0; line < 4; ++line) {
    if (!in.Next() || in.field_count() != 1 || !IsNumber(in.Field(0))) return false;
  }
  return true;
}

// A pixel and a point.
constexpr std::size_t kMinColumns = 5;

std::optional<ProblemFormat> Detect(std::string_view text, const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension == ".yaml" || extension == ".yml") return ProblemFormat::kYaml;
  const CsvText csv(text);
  LineReader in(file, csv.text(), csv.separator());
  if (!in.Next()) return std::nullopt;
  const bool has_marks = csv.separator() != LineReader::Separator::kBlanks;
  const std::size_t count = in.field_count();
  if (!IsNumber(in.Field(0))) {
    if (in.Field(0).ends_with(':')) return ProblemFormat::kYaml;
    if (count >= kMinColumns || (has_marks && count >= 3)) return ProblemFormat::kPairsCsv;
    return std::nullopt;
  }
  if (count == 1) {
    const bool has_rows = in.Next() && in.field_count() >= kMinColumns;
    return has_rows ? ProblemFormat::kPairsCsv : ProblemFormat::kPoints;
  }
  if (count == 3 && has_marks) return ProblemFormat::kAcfrPoses;
  if (count == kMinColumns || count == kMinColumns + 1) return ProblemFormat::kPairsCsv;
  return std::nullopt;
}

tl::unexpected<Error> UnknownFormat(const std::string& file) {
  return MakeError(
      ErrorCode::kParse,
      fmt::format("{}:1: not a problem in a known format; expected points.txt (first line: only "
                  "the number of points), YAML (first line: sextant_problem: 1), a CSV of pairs "
                  "(first line: u,v,x,y,z or camx,camy,camz,lidarx,lidary,lidarz) or poses.csv "
                  "(lines of three numbers)",
                  ToString(Place{.file = file})));
}

// Users who pair the corners in the file's order should know in which poses it differs.
std::vector<std::string> RelabellingNotes(const std::vector<AcfrPose>& poses) {
  const Expected<std::vector<int>> relabelled = RelabelledAcfrPoses(poses);
  if (!relabelled || relabelled->empty()) return {};
  return {
      fmt::format("order: poses {} are relabelled: the file lists their corners in another order "
                  "than those of the other {}; the best-fitting order was used for each",
                  fmt::join(*relabelled, ", "), poses.size() - relabelled->size())};
}

}  // namespace

std::string_view ToString(ProblemFormat format) {
  switch (format) {
    case ProblemFormat::kYaml:
      return "yaml";
    case ProblemFormat::kPoints:
      return "points";
    case ProblemFormat::kPairsCsv:
      return "csv";
    case ProblemFormat::kAcfrPoses:
      return "acfr_poses";
  }
  return "unknown";
}

Expected<DetectedProblem> ReadProblem(const std::filesystem::path& path) {
  return ReadWith(path, ParseProblem);
}

Expected<DetectedProblem> ParseProblem(std::string_view text, const std::string& file) {
  if (IsAverageLog(text, file)) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}:1: this is avg_values.txt, the log of the original package, "
                                 "which has poses and no correspondences; 'sextant average' reads "
                                 "it",
                                 ToString(Place{.file = file})));
  }
  const std::optional<ProblemFormat> format = Detect(text, file);
  if (!format) return UnknownFormat(file);
  DetectedProblem detected;
  detected.format = *format;
  const auto keep_problem = [&](CalibrationProblem&& problem) {
    detected.problem = std::move(problem);
  };
  Expected<void> ok;
  switch (*format) {
    case ProblemFormat::kYaml:
      ok = ParseProblemYaml(text, file).map([&](ProblemFile&& read) {
        static_cast<ProblemFile&>(detected) = std::move(read);
      });
      break;
    case ProblemFormat::kPoints:
      ok = ParsePoints(text, file).map(keep_problem);
      break;
    case ProblemFormat::kPairsCsv:
      ok = ParsePairsCsvWithNotes(text, file, detected.notes).map(keep_problem);
      break;
    case ProblemFormat::kAcfrPoses:
      ok = ParseAcfrPoses(text, file)
               .and_then([&](const std::vector<AcfrPose>& poses) {
                 detected.notes = RelabellingNotes(poses);
                 return ProblemFromAcfrPoses(poses);
               })
               .map(keep_problem);
      break;
  }
  SEXTANT_RETURN_IF_ERROR(std::move(ok));
  SEXTANT_RETURN_IF_ERROR(AtPlace(CheckRange(detected.problem), {.file = file}));
  return detected;
}

}  // namespace sextant
