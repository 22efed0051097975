// SPDX-License-Identifier: Apache-2.0
#include "report/boards_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text/escape.h"
#include "base/units.h"
#include "base/version.h"
#include "eval/statistics/text_table.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxRejected = 3;  // In the text; the JSON has all.

std::string NameOf(const Board& board) {
  return board.name.empty() ? fmt::format("board {}", board.id)
                            : fmt::format("board {} ({})", board.id, board.name);
}

// Standard deviation of a corner: the root of the sum over the axes.
double SigmaOf(const LidarCorners& corners, int corner) {
  return std::sqrt(corners.CovarianceOf(corner).trace());
}

std::string CornerName(std::size_t corner) {
  constexpr std::array<const char*, 4> kNames = {"top", "right", "bottom", "left"};
  return std::string(corner >= 4 ? "inner " : "") + kNames[corner % 4];
}

double KnownEdge(const Board& board, std::size_t edge) {
  if (edge < 4) return board.EdgeLengths()[edge];
  return edge % 2 == 0 ? board.hole->width_m : board.hole->height_m;
}

std::string CornerTable(const LidarCorners& corners, const Board& board) {
  TextTable table({"corner", "x [m]", "y [m]", "z [m]", "sigma [mm]", "edge to next [m]",
                   "known [m]", "edge points", "line gap [mm]"});
  for (std::size_t i = 0; i < corners.in_lidar.size(); ++i) {
    const Eigen::Vector3d& p = corners.in_lidar[i];
    table.AddRow({CornerName(i), Fixed(p.x(), 4), Fixed(p.y(), 4), Fixed(p.z(), 4),
                  Fixed(kMmPerM * SigmaOf(corners, static_cast<int>(i)), 1),
                  Fixed(corners.checks.edge_lengths_m[i], 4), Fixed(KnownEdge(board, i), 4),
                  std::to_string(corners.checks.points_per_edge[i]),
                  Fixed(kMmPerM * corners.checks.line_gaps_m[i], 2)});
  }
  return table.Plain();
}

std::string DescribeFound(const ScanReport& report, const std::vector<Board>& boards) {
  std::string text;
  for (std::size_t i = 0; i < report.search.found.size(); ++i) {
    const BoardPatch& patch = report.search.found[i];
    const Board& board = boards[static_cast<std::size_t>(patch.board)];
    const Eigen::Vector3d center = patch.plane.At(patch.fit.center);
    text += fmt::format(
        "  {}: {:.2f} m away at ({:.3f}, {:.3f}, {:.3f}) m, {} returns on {} rings, plane sigma "
        "{:.1f} mm, outline {:.1f} mm rms, size {:+.1f} % off\n",
        NameOf(board), center.norm(), center.x(), center.y(), center.z(), patch.agreement.points,
        patch.agreement.rings, kMmPerM * patch.plane.sigma_m, kMmPerM * patch.fit.rms_m,
        100.0 * (patch.fit.size_ratio - 1.0));
    const Expected<LidarCorners>& corners = report.corners[i];
    text += corners ? CornerTable(*corners, board)
                    : fmt::format("    no corners: {}\n", corners.error().message);
  }
  return text;
}

std::string DescribeMissing(const ScanReport& report, const std::vector<Board>& boards) {
  std::string text;
  for (std::size_t b = 0; b < boards.size(); ++b) {
    const bool found = std::ranges::any_of(report.search.found, [&](const BoardPatch& patch) {
      return patch.board == static_cast<int>(b);
    });
    if (!found) text += fmt::format("  {}: not found\n", NameOf(boards[b]));
  }
  if (text.empty()) return text;
  if (report.search.rejected.empty()) {
    return text + "  the scan has no free-standing plane of about its size\n";
  }
  text += "  the planes nearest to it in size, and why they are not the board:\n";
  for (std::size_t i = 0; i < std::min(kMaxRejected, report.search.rejected.size()); ++i) {
    const RejectedPatch& patch = report.search.rejected[i];
    text += fmt::format("    at ({:.2f}, {:.2f}, {:.2f}) m, {} returns on {} rings: {}\n",
                        patch.center_in_lidar.x(), patch.center_in_lidar.y(),
                        patch.center_in_lidar.z(), patch.points, patch.rings, patch.why);
  }
  return text;
}

Json PointJson(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

Json CornersJson(const LidarCorners& corners) {
  Json json;
  for (const Eigen::Vector3d& corner : corners.in_lidar) {
    json["in_lidar_m"].push_back(PointJson(corner));
  }
  for (Eigen::Index row = 0; row < corners.covariance.rows(); ++row) {
    const Eigen::VectorXd values = corners.covariance.row(row);
    json["covariance_m2"].push_back(std::vector<double>(values.begin(), values.end()));
  }
  json["edge_lengths_m"] = corners.checks.edge_lengths_m;
  json["points_per_edge"] = corners.checks.points_per_edge;
  json["line_gaps_m"] = corners.checks.line_gaps_m;
  return json;
}

Json BoardJson(const BoardPatch& patch, const Expected<LidarCorners>& corners, const Board& board) {
  Json json;
  json["board"] = board.id;
  json["center_in_lidar_m"] = PointJson(patch.plane.At(patch.fit.center));
  json["returns"] = patch.agreement.points;
  json["rings"] = patch.agreement.rings;
  json["plane_sigma_m"] = patch.plane.sigma_m;
  json["outline_rms_m"] = patch.fit.rms_m;
  json["outline_size_ratio"] = patch.fit.size_ratio;
  if (corners) {
    json["corners"] = CornersJson(*corners);
  } else {
    json["error"] = {{"code", ToString(corners.error().code)},
                     {"message", corners.error().message}};
  }
  return json;
}

}  // namespace

std::string DescribeScans(const std::vector<ScanReport>& reports, const std::vector<Board>& boards,
                          const std::string& extractor) {
  std::string text;
  std::size_t found = 0;
  for (const ScanReport& report : reports) {
    if (report.failure) continue;
    text += fmt::format("{}: {} returns on {} rings\n", report.path, report.returns, report.rings);
    text += DescribeFound(report, boards) + DescribeMissing(report, boards);
    found += report.search.found.size();
  }
  const std::size_t due = boards.size() * reports.size();
  return text + fmt::format("{} of {} {} found in {} {}, corners by {}\n", found, due,
                            due == 1 ? "board" : "boards", reports.size(),
                            reports.size() == 1 ? "scan" : "scans", extractor);
}

std::string ScansJson(const std::vector<ScanReport>& reports, const std::vector<Board>& boards,
                      const std::string& extractor) {
  Json json;
  json["sextant"] = std::string(Version());
  json["extractor"] = extractor;
  json["scans"] = Json::array();
  for (const ScanReport& report : reports) {
    Json scan;
    scan["path"] = report.path;
    if (report.failure) {
      scan["error"] = {{"code", ToString(report.failure->code)},
                       {"message", report.failure->message}};
    }
    scan["returns"] = report.returns;
    scan["rings"] = report.rings;
    scan["boards"] = Json::array();
    for (std::size_t i = 0; i < report.search.found.size(); ++i) {
      const BoardPatch& patch = report.search.found[i];
      scan["boards"].push_back(
          BoardJson(patch, report.corners[i], boards[static_cast<std::size_t>(patch.board)]));
    }
    scan["rejected"] = Json::array();
    for (const RejectedPatch& patch : report.search.rejected) {
      scan["rejected"].push_back({{"center_in_lidar_m", PointJson(patch.center_in_lidar)},
                                  {"returns", patch.points},
                                  {"rings", patch.rings},
                                  {"why", patch.why}});
    }
    json["scans"].push_back(std::move(scan));
  }
  return JsonText(json);
}

}  // namespace sextant
