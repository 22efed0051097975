// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/solve_rig.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "solvers/core/board_view_check.h"
#include "solvers/core/rig_problem_check.h"
#include "solvers/rig/rig_feature_check.h"
#include "solvers/rig/rig_print_scale.h"
#include "solvers/rig/rig_search.h"
#include "solvers/rig/rig_start.h"

namespace sextant {
namespace {

constexpr std::array<std::string_view, kRigKinds> kKindNames = {
    "printed corners",        "returns",           "edges", "points", "planes", "lines",
    "shift out of the plane", "shift in the plane"};

std::string NameOfMoment(const RigPlacement& placement) {
  return placement.name.empty() ? std::to_string(placement.moment) : placement.name;
}

// Returns and edge rays need a pose for the model; what the closed form gives is enough.
Expected<RigProblem> WithPoses(RigProblem problem) {
  for (RigPlacement& placement : problem.placements) {
    const Board& board = *FindBoard(problem.boards, placement.board);
    for (RigObservation& seen : placement.seen) {
      if (seen.sensor_from_board || seen.raw.edges.empty()) continue;
      const auto poses = PosesAlone(seen, problem.sensors[seen.sensor], board);
      if (poses.empty()) {
        return MakeError(ErrorCode::kMissingData,
                         fmt::format("moment {}, board {}: the returns and edges of {} do not show "
                                     "how the board lies; state sensor_from_board",
                                     NameOfMoment(placement), placement.board,
                                     problem.sensors[seen.sensor].name));
      }
      seen.sensor_from_board = poses[0];
    }
  }
  return problem;
}

std::optional<std::size_t> ClockRoot(const RigOptions& options) {
  return options.estimate_time ? std::optional(options.root) : std::nullopt;
}

std::string ClockWarning(const std::string& sensor, const std::string& uncertainty) {
  return fmt::format(
      "the data does not determine the time offset of {}{}: move boards, in several directions, "
      "while {} and "
      "another sensor see them, and state times",
      sensor, uncertainty, sensor);
}

// Whether at least two of the sensors see a board.
bool IsShared(const RigPlacement& placement, std::span<const std::size_t> sensors) {
  std::optional<std::size_t> first;
  for (const RigObservation& seen : placement.seen) {
    if (std::ranges::count(sensors, seen.sensor) == 0) continue;
    if (first && *first != seen.sensor) return true;
    first = seen.sensor;
  }
  return false;
}

/// The connected part of a problem, solved, and how its sensors are numbered in the whole.
class RigSolution {
 public:
  RigSolution(const RigProblem& whole, std::vector<std::size_t> sensors)
      : whole_(whole), sensors_(std::move(sensors)), part_(Restricted(whole, sensors_)) {}

  Expected<void> Solve(const RigTree& tree, RigOptions options) {
    std::vector<Rigid3d> start;
    for (const std::size_t sensor : sensors_) start.push_back(*tree.sensor_from_root[sensor]);
    options.root =
        static_cast<std::size_t>(std::ranges::find(sensors_, options.root) - sensors_.begin());
    options_ = options;
    model_ = RigModelOf(part_, ClockRoot(options));
    SEXTANT_ASSIGN_OR_RETURN(answer_, SearchRig(model_, StateOf(part_, model_, start), options));
    scales_ = PrintScalesNear(model_, answer_, options);
    return {};
  }

  void Report(RigEstimate& estimate) const {
    const auto poses = 6 * (std::ssize(sensors_) - 1);
    estimate.covariance = answer_.covariance.topLeftCorner(poses, poses);
    estimate.iterations = answer_.iterations;
    for (std::size_t s = 0; s < sensors_.size(); ++s) {
      estimate.sensor_from_root[sensors_[s]] = answer_.state.sensor_from_root[s];
    }
    for (std::size_t k = 0; k < model_.numbers.size(); ++k) {
      const RigNumber& number = model_.numbers[k];
      if (!number.reported) continue;
      const auto at = poses + static_cast<Eigen::Index>(k);
      estimate.numbers.push_back({sensors_[number.sensor], number.name, answer_.state.numbers[k],
                                  std::sqrt(answer_.covariance(at, at))});
    }
    ReportFits(estimate);
    ReportNoise(estimate);
    Warn(estimate);
  }

 private:
  // The placements of the part are those of the whole that enough of its sensors see, in order.
  std::vector<std::size_t> PlacementsInWhole() const {
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < whole_.placements.size(); ++i) {
      if (IsShared(whole_.placements[i], sensors_)) indices.push_back(i);
    }
    return indices;
  }

  void ReportFits(RigEstimate& estimate) const {
    const std::vector<std::size_t> placements = PlacementsInWhole();
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> place;
    std::vector<double> squares;
    std::vector<int> rows;
    for (std::size_t k = 0; k < model_.blocks.size(); ++k) {
      const RigBlock& block = model_.blocks[k];
      const auto [at, is_new] =
          place.try_emplace({block.placement, block.seen}, estimate.fits.size());
      if (is_new) {
        estimate.fits.push_back(
            {.placement = placements[block.placement], .sensor = sensors_[block.sensor]});
        squares.push_back(0.0);
        rows.push_back(0);
      }
      RigObservationFit& fit = estimate.fits[at->second];
      fit.of += block.units;
      for (std::size_t i = 0; i < answer_.selection[k].size(); ++i) {
        if (!answer_.selection[k][i]) continue;
        ++fit.units;
        squares[at->second] += block.rows_per_unit * std::pow(answer_.units[k][i], 2);
        rows[at->second] += block.rows_per_unit;
      }
    }
    for (std::size_t i = 0; i < estimate.fits.size(); ++i) {
      estimate.fits[i].used = rows[i] > 0;
      if (rows[i] > 0) estimate.fits[i].rms = std::sqrt(squares[i] / rows[i]);
    }
  }

  void ReportNoise(RigEstimate& estimate) const {
    std::vector<std::array<bool, kRigKinds>> present(sensors_.size());
    for (const RigBlock& block : model_.blocks) {
      present[block.sensor][static_cast<std::size_t>(block.kind)] = true;
    }
    for (std::size_t s = 0; s < sensors_.size(); ++s) {
      for (std::size_t kind = 0; kind < kRigKinds; ++kind) {
        if (!present[s][kind]) continue;
        estimate.noise.push_back({sensors_[s], static_cast<RigKind>(kind), answer_.noise[s][kind]});
      }
    }
  }

  void Warn(RigEstimate& estimate) const {
    for (const RigObservationFit& fit : estimate.fits) {
      if (fit.used) continue;
      const RigPlacement& placement = whole_.placements[fit.placement];
      estimate.warnings.push_back(fmt::format(
          "board {} of moment {} was left out for {}: it contradicts the other sensors; did the "
          "board stand still, and are its corners in the right order?",
          placement.board, NameOfMoment(placement), whole_.sensors[fit.sensor].name));
    }
    WarnOfClocks(estimate);
    RefuteByNoise(estimate);
    RefuteByPrints(estimate);
    RefuteByWhatIsLeft(estimate);
  }

  // An offset that the boards' motion determines is known far better than its prior.
  void WarnOfClocks(RigEstimate& estimate) const {
    constexpr double kDetermined = 0.3;  // Sigma over that of the prior.
    for (std::size_t s = 0; s < sensors_.size() && options_.estimate_time; ++s) {
      if (s == options_.root) continue;
      const auto number =
          std::ranges::find_if(estimate.numbers, [&](const RigEstimatedNumber& one) {
            return one.sensor == sensors_[s] && one.name == kTimeOffset;
          });
      const bool any = number != estimate.numbers.end();
      if (any && number->sigma < kDetermined * kClockSigma_s) continue;
      estimate.warnings.push_back(
          ClockWarning(whole_.sensors[sensors_[s]].name,
                       any ? fmt::format(" (+-{:.0f} ms)", 1e3 * number->sigma) : ""));
    }
  }

  void RefuteByNoise(RigEstimate& estimate) const {
    // A ratio of 1.5 is more than an inaccurate estimate of a sigma; no sigma is wrong by 10.
    constexpr double kMuch = 1.5;
    constexpr double kImpossible = 10.0;
    for (const RigNoiseLevel& noise : estimate.noise) {
      if (noise.level < kMuch) continue;
      if (noise.level > kImpossible) {
        estimate.refutations.push_back(fmt::format(
            "the {} of {} are off by {:.0f} times their stated noise: check that what is listed "
            "under a moment was recorded together, the order of corners, sizes and intrinsics",
            NameOf(noise.kind), whole_.sensors[noise.sensor].name, noise.level));
        continue;
      }
      estimate.warnings.push_back(fmt::format(
          "the noise of the {} of {} is {:.1f} times as large as stated, which the covariance "
          "includes; look for a systematic error (intrinsics, board size)",
          NameOf(noise.kind), whole_.sensors[noise.sensor].name, noise.level));
    }
  }

  void RefuteByPrints(RigEstimate& estimate) const {
    constexpr double kMaxSigmas = 4.0;
    constexpr double kMinShare = 0.005;  // Usual error of prints and focal lengths.
    for (const RigPrintScale& scale : scales_) {
      const double share = std::abs(scale.share);
      if (share < kMinShare || share < kMaxSigmas * scale.sigma) continue;
      estimate.refutations.push_back(fmt::format(
          "the print that {} sees seems to be {:.1f} +- {:.1f} % {} than stated, or its focal "
          "length is wrong by that share: measure the print, and check the intrinsics",
          whole_.sensors[sensors_[scale.sensor]].name, 100.0 * share, 100.0 * scale.sigma,
          scale.share > 0.0 ? "larger" : "smaller"));
    }
  }

  void RefuteByWhatIsLeft(RigEstimate& estimate) const {
    for (const std::size_t sensor : sensors_) {
      const auto seen = std::ranges::count(estimate.fits, sensor, &RigObservationFit::sensor);
      const auto used = std::ranges::count_if(estimate.fits, [&](const RigObservationFit& fit) {
        return fit.sensor == sensor && fit.used;
      });
      if (2 * used >= seen) continue;
      estimate.refutations.push_back(fmt::format(
          "only {} of the {} boards that {} sees agree with the other sensors: check that what is "
          "listed under a moment was recorded together",
          used, seen, whole_.sensors[sensor].name));
    }
  }

  const RigProblem& whole_;
  std::vector<std::size_t> sensors_;
  RigOptions options_;
  RigProblem part_;
  RigModel model_;
  RigAnswer answer_;
  std::vector<RigPrintScale> scales_;
};

}  // namespace

std::string_view NameOf(RigKind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

UncertainPose RigEstimate::Between(std::size_t a, std::size_t b) const {
  // The derivatives of a_from_root * root_from_b by both factors.
  const auto column = [&](std::size_t sensor) {
    Eigen::Index at = 0;
    for (std::size_t s = 0; s < sensor; ++s) at += sensor_from_root[s] && s != root ? 6 : 0;
    return at;
  };
  const Rigid3d root_from_b = sensor_from_root[b]->Inverse();
  const ProductJacobians by = JacobiansOfProduct(*sensor_from_root[a], root_from_b);
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(6, covariance.cols());
  if (a != root) slope.middleCols<6>(column(a)) += by.by_left;
  if (b != root) {
    slope.middleCols<6>(column(b)) += by.by_right * JacobianOfInverse(*sensor_from_root[b]);
  }
  return {.b_from_a = *sensor_from_root[a] * root_from_b,
          .covariance = slope * covariance * slope.transpose()};
}

RigProblem Restricted(const RigProblem& problem, std::span<const std::size_t> sensors) {
  RigProblem part{.boards = problem.boards};
  for (const std::size_t sensor : sensors) part.sensors.push_back(problem.sensors[sensor]);
  for (const RigPlacement& placement : problem.placements) {
    RigPlacement kept{placement.moment, placement.board, placement.name, {}};
    for (const RigObservation& seen : placement.seen) {
      const auto at = std::ranges::find(sensors, seen.sensor);
      if (at == sensors.end()) continue;
      kept.seen.push_back(seen);
      kept.seen.back().sensor = static_cast<std::size_t>(at - sensors.begin());
    }
    if (IsShared(placement, sensors)) part.placements.push_back(std::move(kept));
  }
  return part;
}

namespace {

Expected<RigEstimate> SolveOnce(const RigProblem& given, const RigOptions& options) {
  SEXTANT_RETURN_IF_ERROR(CheckRigProblem(given));
  SEXTANT_RETURN_IF_ERROR(CheckRigFeatures(given));
  SEXTANT_ASSIGN_OR_RETURN(const RigProblem problem, WithPoses(given));
  const RigTree tree = TreeOf(problem, PairsOf(problem), options.root);
  std::vector<std::size_t> connected;
  for (std::size_t s = 0; s < problem.sensors.size(); ++s) {
    if (tree.sensor_from_root[s]) connected.push_back(s);
  }
  if (connected.size() < 2) {
    Error error(ErrorCode::kMissingData, fmt::format("no sensor is connected with '{}'",
                                                     problem.sensors[options.root].name));
    for (const std::string& line : tree.unconnected) error.AddLine(line);
    return tl::unexpected<Error>(std::move(error));
  }
  RigEstimate estimate{.root = options.root,
                       .sensor_from_root = tree.sensor_from_root,
                       .unconnected = tree.unconnected};
  RigSolution solution(problem, connected);
  SEXTANT_RETURN_IF_ERROR(solution.Solve(tree, options));
  solution.Report(estimate);
  return estimate;
}

// The boards as they are at rest: no time passes within a moment.
RigProblem AtRest(RigProblem problem) {
  constexpr double kNoTime = 1e-6;
  for (RigPlacement& placement : problem.placements) {
    std::optional<double> first;
    for (RigObservation& seen : placement.seen) {
      if (!seen.time_s) continue;
      if (!first) first = seen.time_s;
      seen.time_s = *first + kNoTime * (*seen.time_s - *first);
    }
  }
  return problem;
}

/// What the residuals in use amount to, each unit taken as two numbers.
struct RigMisfit {
  explicit RigMisfit(const RigEstimate& estimate) {
    for (const RigObservationFit& fit : estimate.fits) {
      count += fit.used ? 2.0 * fit.units : 0.0;
      squares += fit.used ? 2.0 * fit.units * fit.rms * fit.rms : 0.0;
    }
  }
  double squares = 0.0;
  double count = 0.0;
};

// An offset follows from the boards' velocities, and the noise of these counts as motion: it makes
// the information on the offset too large by the factor 1 / (1 - 1 / F). F is the mean square of
// the six numbers of a motion over their variance.
bool BoardsMove(const RigProblem& problem, RigOptions options) {
  constexpr double kMinF = 10.0;
  constexpr double kMaxLeftOut = 0.05;
  options.estimate_time = false;
  options.progress = {};
  const Expected<RigEstimate> at_rest = SolveOnce(AtRest(problem), options);
  const Expected<RigEstimate> moving = SolveOnce(problem, options);
  if (!at_rest || !moving) return true;
  const RigMisfit rest(*at_rest);
  const RigMisfit motion(*moving);
  if (rest.count < (1.0 - kMaxLeftOut) * motion.count) return true;
  const double moved = 6.0 * static_cast<double>(problem.placements.size());
  const double redundant = std::max(1.0, motion.count - 2.0 * moved);
  return (rest.squares - motion.squares) / moved > kMinF * motion.squares / redundant;
}

}  // namespace

Expected<RigEstimate> SolveRig(const RigProblem& problem, const RigOptions& options) {
  if (!options.estimate_time || options.boards_move || BoardsMove(problem, options)) {
    return SolveOnce(problem, options);
  }
  RigOptions without_clocks = options;
  without_clocks.estimate_time = false;
  SEXTANT_ASSIGN_OR_RETURN(RigEstimate estimate, SolveOnce(problem, without_clocks));
  for (std::size_t s = 0; s < problem.sensors.size(); ++s) {
    if (s == options.root || !estimate.sensor_from_root[s]) continue;
    estimate.warnings.push_back(ClockWarning(problem.sensors[s].name, ""));
  }
  return estimate;
}

Expected<Eigen::MatrixXd> RigBound(const RigProblem& given, std::size_t root,
                                   const std::vector<Rigid3d>& sensor_from_root,
                                   const std::vector<Rigid3d>& root_from_board) {
  SEXTANT_ASSIGN_OR_RETURN(const RigProblem problem, WithPoses(given));
  const RigModel model = RigModelOf(problem);
  RigState state = StateOf(problem, model, sensor_from_root);
  state.root_from_board = root_from_board;
  RigSelection all;
  for (const RigBlock& block : model.blocks) {
    all.emplace_back(static_cast<std::size_t>(block.units), true);
  }
  RigNoise stated(model.sensors);
  for (auto& levels : stated) levels.fill(1.0);
  RigMinimum minimum(model, root, state);
  minimum.SetWeights(WeightsFor(model, state, UnitsAt(model, state), all, stated,
                                std::numeric_limits<double>::infinity()));
  const auto information = RigInformationOf(minimum.Linearise());
  if (!information) {
    return MakeError(ErrorCode::kDegenerate, "the views leave a direction undetermined");
  }
  const auto poses = 6 * (std::ssize(sensor_from_root) - 1);
  return Eigen::MatrixXd(information->covariance.topLeftCorner(poses, poses));
}

}  // namespace sextant
