// SPDX-License-Identifier: Apache-2.0
#include "io/problems/pairs_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "base/nearest_name.h"
#include "io/text/line_reader.h"
#include "io/text/max_id.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

using Names = std::vector<std::string>;

const Names& KnownColumns() {
  static const Names kNames = {"u",       "v",    "x",      "y",      "z",      "camx",
                               "camy",    "camz", "lidarx", "lidary", "lidarz", "sigma_px",
                               "sigma_m", "id",   "view",   "board",  "corner"};
  return kNames;
}

// Access to the fields of a row by the names of the columns.
class Columns {
 public:
  explicit Columns(LineReader& in) : in_(in) {
    if (!in.Require("a header line with the names of the columns")) return;
    for (std::size_t i = 0; i < in.field_count(); ++i) Add(std::string(in.Field(i)));
  }

  bool Has(std::string_view name) const { return Index(name) < names_.size(); }
  void Require(const Names& needed) {
    for (const std::string& name : needed) {
      if (Has(name)) continue;
      in_.Fail(ErrorCode::kParse,
               fmt::format("expected the columns {}; {} is missing", fmt::join(needed, ","), name));
    }
  }
  std::string RowForm() const {
    return fmt::format("{} values ({})", names_.size(), fmt::join(names_, ","));
  }
  std::size_t size() const { return names_.size(); }

  std::string_view Text(std::string_view name) const { return in_.Field(Index(name)); }
  double Real(std::string_view name) { return in_.Real(Index(name), name); }
  double RealOr(std::string_view name, double default_value) {
    return Has(name) ? Real(name) : default_value;
  }
  int IntegerOr(std::string_view name, int default_value) {
    return Has(name) ? static_cast<int>(in_.Integer(Index(name), 0, kMaxId, name)) : default_value;
  }
  int Part(std::string_view text, std::string_view name) {
    return static_cast<int>(in_.IntegerOf(text, Index(name), 0, kMaxId, name));
  }
  Eigen::Vector3d Point(const char* x, const char* y, const char* z) {
    const double px = Real(x);
    const double py = Real(y);
    const double pz = Real(z);
    return {px, py, pz};
  }

 private:
  std::size_t Index(std::string_view name) const {
    return static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
  }
  void Add(std::string name) {
    const Names& known = KnownColumns();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      in_.Fail(ErrorCode::kParse,
               fmt::format("unknown column {}; {}", Quoted(name), SuggestName(name, known)));
    }
    if (Has(name)) {
      in_.Fail(ErrorCode::kParse, fmt::format("the column {} appears twice", Quoted(name)));
    }
    names_.push_back(std::move(name));
  }

  LineReader& in_;
  Names names_;
};

PairId ReadId(Columns& row, std::size_t index) {
  if (!row.Has("id")) {
    const bool named = row.Has("board");
    return {.view = row.IntegerOr("view", 0),
            .board = named ? row.IntegerOr("board", 0) : static_cast<int>(index),
            .corner = row.IntegerOr("corner", 0)};
  }
  const std::string_view id = row.Text("id");
  const std::size_t first = id.find(':');
  if (first == std::string_view::npos) return {.view = 0, .board = row.Part(id, "id"), .corner = 0};
  const std::size_t last = id.rfind(':');
  PairId parsed;
  std::string_view board = id.substr(0, last);
  if (first != last) {
    parsed.view = row.Part(id.substr(0, first), "id");
    board = id.substr(first + 1, last - first - 1);
  }
  parsed.board = row.Part(board, "id");
  parsed.corner = row.Part(id.substr(last + 1), "id");
  return parsed;
}

double ReadSigma(LineReader& in, Columns& row, std::string_view name) {
  const double sigma = row.RealOr(name, 0.0);
  if (sigma < 0.0) in.Fail(ErrorCode::kParse, fmt::format("expected {} >= 0, got {}", name, sigma));
  return sigma;
}

void CheckHeader(LineReader& in, Columns& columns, bool is_2d3d) {
  if (!in.ok()) return;
  if (is_2d3d) {
    columns.Require({"u", "v", "x", "y", "z"});
  } else {
    columns.Require({"camx", "camy", "camz", "lidarx", "lidary", "lidarz"});
  }
  const Names others =
      is_2d3d ? Names{"camx", "lidarx", "sigma_m"} : Names{"x", "y", "z", "sigma_px"};
  for (const std::string& other : others) {
    if (columns.Has(other)) {
      in.Fail(ErrorCode::kParse, fmt::format("the column {} belongs to the other kind of pairs; "
                                             "put each kind into a separate file",
                                             other));
    }
  }
  if (columns.Has("id") && (columns.Has("view") || columns.Has("board") || columns.Has("corner"))) {
    in.Fail(ErrorCode::kParse, "expected either id, or view, board and corner");
  }
  if (columns.Has("board") != columns.Has("corner")) {
    in.Fail(ErrorCode::kParse, "expected both of the columns board and corner");
  }
}

}  // namespace

Expected<CalibrationProblem> ReadPairsCsv(const std::filesystem::path& path) {
  return ReadWith(path, ParsePairsCsv);
}

Expected<CalibrationProblem> ParsePairsCsv(std::string_view text, const std::string& file) {
  LineReader in(file, text, LineReader::Separator::kCommas);
  Columns row(in);
  const bool is_2d3d = row.Has("u") || row.Has("v");
  CheckHeader(in, row, is_2d3d);
  const std::string form = row.RowForm();
  CalibrationProblem problem;
  for (std::size_t i = 0; in.Next() && in.HasFields(row.size(), form); ++i) {
    if (is_2d3d) {
      Pair2d3d& pair = problem.pairs_2d3d.emplace_back();
      pair.pixel.x() = row.Real("u");
      pair.pixel.y() = row.Real("v");
      pair.point_in_lidar = row.Point("x", "y", "z");
      pair.sigma_px = ReadSigma(in, row, "sigma_px");
      pair.id = ReadId(row, i);
    } else {
      Pair3d3d& pair = problem.pairs_3d3d.emplace_back();
      pair.point_in_cam = row.Point("camx", "camy", "camz");
      pair.point_in_lidar = row.Point("lidarx", "lidary", "lidarz");
      pair.sigma_m = ReadSigma(in, row, "sigma_m");
      pair.id = ReadId(row, i);
    }
  }
  if (in.ok() && problem.pairs_2d3d.empty() && problem.pairs_3d3d.empty()) {
    in.Fail(ErrorCode::kParse, fmt::format("expected rows of {} after the header", form));
  }
  if (!in.ok()) return in.TakeError();
  problem.point_sets = WithholdPairing(problem.pairs_3d3d);
  return problem;
}

std::string FormatPairsCsv(std::span<const Pair2d3d> pairs) {
  std::string text = "u,v,x,y,z,sigma_px,view,board,corner\n";
  for (const Pair2d3d& pair : pairs) {
    const Eigen::Vector3d& p = pair.point_in_lidar;
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{}\n", pair.pixel.x(),
                   pair.pixel.y(), p.x(), p.y(), p.z(), pair.sigma_px, pair.id.view, pair.id.board,
                   pair.id.corner);
  }
  return text;
}

std::string FormatPairsCsv(std::span<const Pair3d3d> pairs) {
  std::string text = "camx,camy,camz,lidarx,lidary,lidarz,sigma_m,view,board,corner\n";
  for (const Pair3d3d& pair : pairs) {
    const Eigen::Vector3d& c = pair.point_in_cam;
    const Eigen::Vector3d& l = pair.point_in_lidar;
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{}\n", c.x(), c.y(), c.z(),
                   l.x(), l.y(), l.z(), pair.sigma_m, pair.id.view, pair.id.board, pair.id.corner);
  }
  return text;
}

}  // namespace sextant
