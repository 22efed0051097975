// SPDX-License-Identifier: Apache-2.0
#include "io/problems/pairs_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "base/text/printable.h"
#include "io/problems/csv_header.h"
#include "io/text/line_reader.h"
#include "io/text/max_id.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

// Access to the fields of a row by the names of the columns.
class Columns {
 public:
  Columns(LineReader& in, CsvHeader header) : in_(in), header_(std::move(header)) {}

  bool Has(std::string_view name) const { return Index(name) < names().size(); }
  void Require(const std::vector<std::string>& needed) {
    for (const std::string& name : needed) {
      if (Has(name)) continue;
      in_.Fail(ErrorCode::kParse,
               fmt::format("expected the columns {}; {} is missing", fmt::join(needed, ","), name));
    }
  }
  std::string RowForm() const {
    constexpr std::size_t kMaxNames = 200;
    return fmt::format("{} values ({})", names().size(),
                       Printable(fmt::format("{}", fmt::join(names(), ",")), kMaxNames));
  }
  const std::vector<std::string>& names() const { return header_.columns; }

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
    return static_cast<std::size_t>(std::find(names().begin(), names().end(), name) -
                                    names().begin());
  }

  LineReader& in_;
  CsvHeader header_;
};

// Whether the ids are names, such as p2, which do not name boards.
bool IsNameOfPoint(std::string_view id) {
  return !id.empty() && id.find(':') == std::string_view::npos && (id[0] < '0' || id[0] > '9') &&
         id[0] != '-' && id[0] != '+';
}

PairId ReadId(Columns& row, std::size_t index) {
  if (!row.Has("id") || IsNameOfPoint(row.Text("id"))) {
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
  const std::vector<std::string> others =
      is_2d3d ? std::vector<std::string>{"camx", "lidarx", "sigma_m"}
              : std::vector<std::string>{"x", "y", "z", "sigma_px"};
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

// Whether the row has a value for each column.
bool IsRow(LineReader& in, const Columns& row, const std::string& form) {
  const std::size_t wanted = row.names().size();
  if (in.field_count() == 2 * wanted) {
    in.Fail(ErrorCode::kParse,
            fmt::format("expected {}, got {} fields; if the numbers have decimal commas, separate "
                        "the columns by semicolons",
                        form, in.field_count()));
  }
  return in.HasFields(wanted, form);
}

void ReadRow(LineReader& in, Columns& row, bool is_2d3d, CalibrationProblem& problem) {
  if (is_2d3d) {
    const std::size_t index = problem.pairs_2d3d.size();
    Pair2d3d& pair = problem.pairs_2d3d.emplace_back();
    pair.pixel.x() = row.Real("u");
    pair.pixel.y() = row.Real("v");
    pair.point_in_lidar = row.Point("x", "y", "z");
    pair.sigma_px = ReadSigma(in, row, "sigma_px");
    pair.id = ReadId(row, index);
    return;
  }
  const std::size_t index = problem.pairs_3d3d.size();
  Pair3d3d& pair = problem.pairs_3d3d.emplace_back();
  pair.point_in_cam = row.Point("camx", "camy", "camz");
  pair.point_in_lidar = row.Point("lidarx", "lidary", "lidarz");
  pair.sigma_m = ReadSigma(in, row, "sigma_m");
  pair.id = ReadId(row, index);
}

}  // namespace

Expected<CalibrationProblem> ReadPairsCsv(const std::filesystem::path& path) {
  return ReadWith(path, ParsePairsCsv);
}

Expected<CalibrationProblem> ParsePairsCsv(std::string_view text, const std::string& file) {
  std::vector<std::string> notes;
  return ParsePairsCsvWithNotes(text, file, notes);
}

Expected<CalibrationProblem> ParsePairsCsvWithNotes(std::string_view text, const std::string& file,
                                                    std::vector<std::string>& notes) {
  const CsvText csv(text);
  LineReader in(file, csv.text(), csv.separator());
  if (!in.Require("a header line with the names of the columns")) return in.TakeError();
  CsvHeader header = ReadCsvHeader(in);
  const bool has_names = header.has_names;
  notes = header.notes;
  Columns row(in, std::move(header));
  const bool is_2d3d = row.Has("u") || row.Has("v");
  CheckHeader(in, row, is_2d3d);
  const std::string form = row.RowForm();
  CalibrationProblem problem;
  for (bool any = !has_names || in.Next(); any && in.ok() && IsRow(in, row, form);
       any = in.Next()) {
    ReadRow(in, row, is_2d3d, problem);
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
