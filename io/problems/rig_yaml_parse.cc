// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <initializer_list>
#include <map>

#include "base/units.h"
#include "geometry/board_check.h"
#include "io/blocks/board_block.h"
#include "io/blocks/board_view_block.h"
#include "io/blocks/camera_block.h"
#include "io/blocks/pose_block.h"
#include "io/cameras/camera_file.h"
#include "io/problems/feature_moments.h"
#include "io/problems/feature_table.h"
#include "io/problems/rig_yaml.h"
#include "io/text/max_id.h"
#include "io/text/text_file.h"
#include "io/text/yaml_fields.h"
#include "solvers/core/rig_problem_check.h"

namespace sextant {
namespace {

using RigKeys = std::vector<std::string>;

constexpr std::size_t kMaxNumbers = 2 * kMaxPointsSeen;  // For the points of one board.
// For the covariances of all pixels, which grow with the square of the pixels of an observation.
constexpr std::size_t kMaxCovarianceNumbers = std::size_t{128} << 20;

class RigReader {
 public:
  explicit RigReader(const std::string& file)
      : in_(file), folder_(std::filesystem::path(file).parent_path()) {}

  Expected<RigFile> Read(const YamlNode& root) {
    static const RigKeys kKeys = {"sextant_rig", "comment", "root",   "sensors",
                                  "boards",      "tables",  "moments"};
    if (in_.IsMap(root, "sextant_rig", kKeys)) {
      in_.IntegerAt(root, "sextant_rig", 1, 1);
      ReadSensors(in_.Require(root, "sensors"));
      ReadBoards(in_.Require(root, "boards"));
      if (const YamlNode* name = root.Find("root")) rig_.root = SensorNamed(*name, "root");
      const YamlNode* tables = root.Find("tables");
      const YamlNode* moments = root.Find("moments");
      if (tables == nullptr && moments == nullptr) in_.Require(root, "moments");
      if (moments != nullptr) {
        CheckPixels(*moments);
        ReadMoments(*moments);
      }
      if (tables != nullptr) ReadTables(*tables);
    }
    if (!in_.ok()) return in_.TakeError();
    if (const Expected<void> ok = CheckRigProblem(rig_.problem); !ok) {
      return MakeError(ok.error().code, in_.file() + ": " + ok.error().message);
    }
    return std::move(rig_);
  }

 private:
  void ReadSensors(const YamlNode& list) {
    static const RigKeys kKeys = {"name", "camera", "camera_file", "lidar_errors",
                                  "true_rig_from_sensor"};
    if (!in_.IsSequence(list, "sensors", kMaxRigSensors)) return;
    for (const YamlNode& node : list.items) {
      if (!in_.IsMap(node, "sensors", kKeys)) return;
      RigSensor sensor{.name = in_.FileName(in_.Require(node, "name"), "name")};
      if (const YamlNode* camera = node.Find("camera"))
        sensor.camera = ReadCameraBlock(in_, *camera);
      if (node.Find("camera_file") != nullptr) sensor.camera = CameraIn(node);
      if (const YamlNode* errors = node.Find("lidar_errors")) {
        sensor.lidar_errors = ReadLidarErrors(in_, *errors);
      }
      if (const YamlNode* pose = node.Find("true_rig_from_sensor")) {
        rig_.true_rig_from_sensor.push_back(ReadPoseBlock(in_, *pose, "true_rig_from_sensor"));
      }
      rig_.problem.sensors.push_back(std::move(sensor));
    }
    const std::size_t truths = rig_.true_rig_from_sensor.size();
    if (in_.ok() && truths != 0 && truths != rig_.problem.sensors.size()) {
      in_.Fail(list.line, "true_rig_from_sensor", "expected it for every sensor, or for none");
    }
  }

  std::optional<Camera> CameraIn(const YamlNode& node) {
    const std::string name = in_.TextAt(node, "camera_file");
    if (!in_.ok()) return std::nullopt;
    const Expected<Camera> camera = ReadCamera(folder_ / name);
    if (camera) return *camera;
    in_.Fail(node.line, "camera_file", camera.error().message);
    return std::nullopt;
  }

  void ReadBoards(const YamlNode& list) {
    static const RigKeys kKeys = {
        "id", "top_right_m", "right_bottom_m", "hole", "round_holes", "points_m", "grid"};
    if (!in_.IsSequence(list, "boards", kMaxBoards)) return;
    for (const YamlNode& node : list.items) {
      if (!in_.IsMap(node, "boards", kKeys)) return;
      FeatureBoard board;
      board.board.id = in_.IntegerAt(node, "id", 0, kMaxId);
      if (node.Find("points_m") != nullptr) board.points = Points2At(node, "points_m");
      if (const YamlNode* grid = node.Find("grid")) board.points = GridPoints(*grid);
      ReadSize(node, board);
      ReadOpenings(in_, node, board.board);
      if (!in_.ok()) return;
      if (!(board.board.top_right_m > 0.0 && board.board.right_bottom_m > 0.0)) {
        return in_.Fail(node.line, "boards", "expected sides longer than 0");
      }
      if (board.points.empty()) {
        const std::vector<Eigen::Vector2d> corners = CornersInBoard(board.board);
        board.points.assign(corners.begin(), corners.begin() + kCornersPerBoard);
      }
      rig_.problem.boards.push_back(board.board);
      if (!boards_.emplace(board.board.id, std::move(board)).second) {
        return in_.Fail(node.line, "id", "expected another id: an earlier board has it");
      }
    }
  }

  // A board whose sides nobody measures needs no size: that of its points will do.
  void ReadSize(const YamlNode& node, FeatureBoard& board) {
    const bool none = node.Find("top_right_m") == nullptr && node.Find("right_bottom_m") == nullptr;
    board.has_size = !none || board.points.empty();
    if (board.has_size) {
      board.board.top_right_m = in_.RealAt(node, "top_right_m");
      board.board.right_bottom_m = in_.RealAt(node, "right_bottom_m");
      return;
    }
    Eigen::Vector2d reach = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& point : board.points) reach = reach.cwiseMax(point.cwiseAbs());
    board.board.top_right_m = 2.0 * reach.x();
    board.board.right_bottom_m = 2.0 * reach.y();
  }

  // Row by row from the top left, as seen from the front.
  std::vector<Eigen::Vector2d> GridPoints(const YamlNode& node) {
    static const RigKeys kKeys = {"columns", "rows", "step_m", "center_m"};
    constexpr int kMaxSide = 100;
    std::vector<Eigen::Vector2d> points;
    if (!in_.IsMap(node, "grid", kKeys)) return points;
    const int columns = in_.IntegerAt(node, "columns", 2, kMaxSide);
    const int rows = in_.IntegerAt(node, "rows", 2, kMaxSide);
    const double step_m = in_.RealAt(node, "step_m");
    const Eigen::Vector2d center = in_.Point2At(node, "center_m", Eigen::Vector2d::Zero());
    if (in_.ok() && !(step_m > 0.0)) in_.Fail(node.line, "step_m", "expected more than 0");
    if (columns * rows > kMaxPointsSeen) {
      in_.Fail(node.line, "grid", fmt::format("expected at most {} points", kMaxPointsSeen));
    }
    for (int row = 0; row < rows && in_.ok(); ++row) {
      for (int column = 0; column < columns; ++column) {
        points.push_back(center + step_m * Eigen::Vector2d(column - 0.5 * (columns - 1),
                                                           row - 0.5 * (rows - 1)));
      }
    }
    return points;
  }

  // Names of tables relative to the rig file: one, or a list.
  void ReadTables(const YamlNode& node) {
    constexpr std::size_t kMaxTables = 100;
    std::vector<const YamlNode*> names = {&node};
    if (node.kind != YamlNode::Kind::kText) {
      if (!in_.IsSequence(node, "tables", kMaxTables)) return;
      names.clear();
      for (const YamlNode& item : node.items) names.push_back(&item);
    }
    std::vector<FeatureTable> tables;
    for (const YamlNode* name : names) {
      const std::string file = in_.Text(*name, "tables");
      if (!in_.ok()) return;
      const std::filesystem::path path = folder_ / file;
      auto rows = ReadFeatureTable(path);
      if (!rows) return in_.Fail(rows.error());
      tables.push_back({path.string(), std::move(*rows)});
    }
    const auto added = AddFeatures(std::move(tables), boards_, rig_.problem);
    if (!added) return in_.Fail(added.error());
  }

  // x0, y0, x1, y1, ...
  std::vector<Eigen::Vector2d> Points2At(const YamlNode& map, std::string_view key) {
    const YamlNode& node = in_.Require(map, key);
    const std::vector<double> numbers = in_.RealList(node, key, kMaxNumbers);
    std::vector<Eigen::Vector2d> points;
    if (numbers.size() % 2 != 0) {
      in_.Fail(node.line, key,
               fmt::format("expected two numbers per point, got {} numbers", numbers.size()));
    }
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
      points.emplace_back(numbers[i], numbers[i + 1]);
    }
    return points;
  }

  std::size_t SensorNamed(const YamlNode& node, std::string_view key) {
    const std::string name = in_.Text(node, key);
    const auto& sensors = rig_.problem.sensors;
    const auto at = std::ranges::find(sensors, name, &RigSensor::name);
    if (!in_.ok() || at != sensors.end()) return static_cast<std::size_t>(at - sensors.begin());
    std::string known;
    for (const RigSensor& sensor : sensors) known += (known.empty() ? "" : ", ") + sensor.name;
    in_.Fail(node.line, key,
             fmt::format("expected the name of a sensor ({}), got '{}'", known, name));
    return 0;
  }

  // Before any covariance is made.
  void CheckPixels(const YamlNode& moments) {
    std::size_t numbers = 0;
    for (const YamlNode& moment : moments.items) {
      const YamlNode* seen = moment.Find("observations");
      if (seen == nullptr) continue;
      for (const YamlNode& node : seen->items) {
        const YamlNode* pixels = node.Find("pixels");
        if (pixels != nullptr) numbers += pixels->items.size() * pixels->items.size();
        if (numbers <= kMaxCovarianceNumbers) continue;
        return in_.Fail(node.line, "pixels",
                        fmt::format("expected fewer pixels: the covariances of all observations up "
                                    "to this one would take more than {} MiB",
                                    (kMaxCovarianceNumbers * sizeof(double)) >> 20));
      }
    }
  }

  void ReadMoments(const YamlNode& list) {
    static const RigKeys kKeys = {"name", "observations"};
    if (!in_.IsSequence(list, "moments")) return;
    int moment = 0;
    for (const YamlNode& node : list.items) {
      if (!in_.IsMap(node, "moments", kKeys)) return;
      const YamlNode* name = node.Find("name");
      const YamlNode& seen = in_.Require(node, "observations");
      std::map<int, RigPlacement> placements;
      if (!in_.IsSequence(seen, "observations")) return;
      for (const YamlNode& item : seen.items) {
        const int board = ReadObservation(item);
        if (!in_.ok()) return;
        RigPlacement& placement = placements[board];
        placement.moment = moment;
        placement.board = board;
        if (name != nullptr) placement.name = in_.Text(*name, "name");
        placement.seen.push_back(std::move(observation_));
      }
      for (auto& [board, placement] : placements) {
        rig_.problem.placements.push_back(std::move(placement));
      }
      ++moment;
    }
  }

  // Fills observation_; returns the board.
  int ReadObservation(const YamlNode& node) {
    static const RigKeys kKeys = {"sensor",        "board",  "in_board_m", "pixels",
                                  "sigma_px",      "time_s", "points_m",   "plane",
                                  "sigma_m",       "lines",  "face_m",     "face_rings",
                                  "range_sigma_m", "edges",  "printed",    "sensor_from_board"};
    observation_ = {};
    if (!in_.IsMap(node, "observations", kKeys)) return 0;
    observation_.sensor = SensorNamed(in_.Require(node, "sensor"), "sensor");
    const int id = in_.IntegerAt(node, "board", 0, kMaxId);
    const auto board = boards_.find(id);
    if (in_.ok() && board == boards_.end()) {
      in_.Fail(node.line, "board", fmt::format("expected the id of one of the boards, got {}", id));
    }
    if (!in_.ok()) return 0;
    CheckUsed(node, "sigma_px", {"pixels"});
    CheckUsed(node, "sigma_m", {"points_m"});
    CheckUsed(node, "in_board_m", {"pixels", "points_m"});
    std::vector<Eigen::Vector2d> points = board->second.points;
    if (node.Find("in_board_m") != nullptr) points = Points2At(node, "in_board_m");
    if (node.Find("time_s") != nullptr) observation_.time_s = in_.RealAt(node, "time_s");
    if (node.Find("pixels") != nullptr) ReadPixels(node, points);
    if (const YamlNode* list = node.Find("points_m")) ReadPoints(node, *list, points);
    if (const YamlNode* plane = node.Find("plane")) ReadPlane(*plane);
    if (const YamlNode* lines = node.Find("lines")) ReadLines(*lines, board->second);
    ReadObservations(in_, node, "face_m", observation_.raw);
    if (const YamlNode* pose = node.Find("sensor_from_board")) {
      observation_.sensor_from_board = ReadPoseBlock(in_, *pose, "sensor_from_board");
    }
    return id;
  }

  // Refuses a key that describes measurements which are not there.
  void CheckUsed(const YamlNode& node, std::string_view key,
                 std::initializer_list<std::string_view> measured) {
    const auto is_there = [&](std::string_view name) { return node.Find(name) != nullptr; };
    if (!in_.ok() || !is_there(key) || std::ranges::any_of(measured, is_there)) return;
    in_.Fail(node.line, key,
             fmt::format("describes {}, which the observation does not have; leave it out",
                         fmt::join(measured, " or ")));
  }

  // Whether there are as many measurements as points of the board.
  bool IsAsMany(int line, std::string_view key, std::size_t measured, std::size_t points) {
    if (!in_.ok() || measured == points) return in_.ok();
    in_.Fail(line, key,
             fmt::format("expected {} points, as many as the board's points_m or the observation's "
                         "in_board_m, got {}",
                         points, measured));
    return false;
  }

  void ReadPixels(const YamlNode& node, const std::vector<Eigen::Vector2d>& points) {
    BoardPoints printed{.in_board_m = points, .pixels = Points2At(node, "pixels")};
    const double sigma = in_.RealAt(node, "sigma_px", kUsualSigma_px);
    if (!(sigma > 0.0)) in_.Fail(node.line, "sigma_px", "expected a sigma above 0");
    if (!IsAsMany(node.line, "pixels", printed.pixels.size(), points.size())) return;
    const auto size = 2 * std::ssize(points);
    printed.covariance_px2 = sigma * sigma * Eigen::MatrixXd::Identity(size, size);
    observation_.raw.printed.push_back(std::move(printed));
  }

  void ReadPoints(const YamlNode& node, const YamlNode& list,
                  const std::vector<Eigen::Vector2d>& points) {
    if (!in_.IsSequence(list, "points_m", kMaxNumbers)) return;
    if (!IsAsMany(list.line, "points_m", list.items.size(), points.size())) return;
    const std::vector<double> sigmas = SigmasAt(node, points.size());
    for (std::size_t i = 0; i < points.size() && in_.ok(); ++i) {
      MeasuredPoint point{.sigma_m = sigmas[i]};
      point.in_board_m << points[i], 0.0;
      point.in_sensor_m = in_.Point(list.items[i], "points_m");
      observation_.points.push_back(point);
    }
  }

  // One of all points, or a list with that of each.
  std::vector<double> SigmasAt(const YamlNode& node, std::size_t points) {
    const YamlNode* list = node.Find("sigma_m");
    if (list == nullptr || list->kind != YamlNode::Kind::kSequence) {
      return std::vector<double>(points, in_.RealAt(node, "sigma_m", MeasuredPoint{}.sigma_m));
    }
    std::vector<double> sigmas = in_.RealList(*list, "sigma_m", kMaxNumbers);
    if (in_.ok() && sigmas.size() != points) {
      in_.Fail(list->line, "sigma_m",
               fmt::format("expected one number, or {}, as many as points_m, got {}", points,
                           sigmas.size()));
    }
    return sigmas;
  }

  void ReadPlane(const YamlNode& node) {
    static const RigKeys kKeys = {"normal", "distance_m", "sigma_m", "sigma_deg"};
    MeasuredPlane plane;
    if (!in_.IsMap(node, "plane", kKeys)) return;
    plane.normal = DirectionAt(node, "normal");
    plane.distance_m = in_.RealAt(node, "distance_m");
    plane.sigma_m = in_.RealAt(node, "sigma_m", plane.sigma_m);
    plane.sigma_rad = kRadPerDeg * in_.RealAt(node, "sigma_deg", plane.sigma_rad * kDegPerRad);
    observation_.plane = plane;
  }

  void ReadLines(const YamlNode& list, const FeatureBoard& board) {
    static const RigKeys kKeys = {"side", "point_m", "direction", "sigma_m"};
    if (!in_.IsSequence(list, "lines", 2 * kCornersPerBoard)) return;
    if (!board.has_size) {
      return in_.Fail(list.line, "lines",
                      "lines along sides need the board's size: state top_right_m and "
                      "right_bottom_m");
    }
    for (const YamlNode& node : list.items) {
      if (!in_.IsMap(node, "lines", kKeys)) return;
      MeasuredLine line;
      line.side = in_.IntegerAt(node, "side", 0, 2 * kCornersPerBoard - 1);
      line.point = in_.PointAt(node, "point_m");
      line.direction = DirectionAt(node, "direction");
      line.sigma_m = in_.RealAt(node, "sigma_m", line.sigma_m);
      observation_.lines.push_back(line);
    }
  }

  // The vector may have any length, as other programs write it.
  Eigen::Vector3d DirectionAt(const YamlNode& map, std::string_view key) {
    const Eigen::Vector3d direction = in_.PointAt(map, key);
    const double length = direction.norm();
    if (in_.ok() && !(length > 1e-9)) in_.Fail(map.line, key, "expected a direction, not zeros");
    return std::abs(length - 1.0) > 1e-12 ? (direction / length).eval() : direction;
  }

  YamlFields in_;
  std::filesystem::path folder_;
  std::map<int, FeatureBoard> boards_;
  RigObservation observation_;
  RigFile rig_;
};

}  // namespace

Expected<RigFile> ReadRigFile(const std::filesystem::path& path) {
  return ReadWith(path, ParseRigFile);
}

Expected<RigFile> ParseRigFile(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  if (root.kind == YamlNode::Kind::kMap && root.Find("sextant_rig") == nullptr) {
    YamlFields in(file);
    in.Fail(root.line, {},
            "expected a rig file, with the key sextant_rig: 1; is this another kind of YAML?");
    return in.TakeError();
  }
  return RigReader(file).Read(root);
}

bool IsRigFile(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    const bool skipped = line.empty() || line[0] == '#' || line[0] == '\r' || line[0] == '%' ||
                         line.starts_with("---");
    if (!skipped) return line.starts_with("sextant_rig:");
    at = end + 1;
  }
  return false;
}

}  // namespace sextant
