// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_search.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

namespace sextant {
namespace {

constexpr int kMaxRounds = 10;
// Relative change of the noise below which the losses are not updated.
constexpr double kSameNoise = 0.02;
// Tolerance [rad, m] of the minimum of the losses where it is only the start for the cut.
constexpr double kNearEnough = 1e-4;

bool Any(const std::vector<bool>& chosen) {
  return std::find(chosen.begin(), chosen.end(), true) != chosen.end();
}

// The observations of one sensor alone carry no information on the extrinsic.
void DropOneSided(JointSelection& selection) {
  for (JointViewSelection& view : selection) {
    if (Any(view.printed) && (Any(view.face) || Any(view.edges))) continue;
    for (std::vector<bool>* kind : {&view.printed, &view.face, &view.edges}) {
      kind->assign(kind->size(), false);
    }
  }
}

bool AnyView(const JointSelection& selection) {
  return std::any_of(selection.begin(), selection.end(),
                     [](const JointViewSelection& view) { return Any(view.printed); });
}

RobustLoss LossOf(JointLoss kind, double scale) {
  constexpr LossKind kKinds[] = {LossKind::kNone, LossKind::kHuber, LossKind::kCauchy};
  return {.kind = kKinds[static_cast<std::size_t>(kind)], .scale = scale};
}

JointLosses LossesOf(const JointOptions& options, const JointNoise& noise) {
  return {LossOf(options.pixel_loss, options.loss_scale * noise.printed),
          LossOf(options.face_loss, options.loss_scale * noise.face),
          LossOf(options.edge_loss, options.loss_scale * noise.edges)};
}

bool IsSame(double a, double b) { return std::abs(a - b) <= kSameNoise * b; }
bool IsSame(const JointNoise& a, const JointNoise& b) {
  return IsSame(a.printed, b.printed) && IsSame(a.face, b.face) && IsSame(a.edges, b.edges);
}

class JointSearch {
 public:
  JointSearch(const std::vector<JointView>& views, const JointUnknowns& unknowns,
              const JointOptions& options)
      : views_(views), unknowns_(unknowns), options_(options) {}

  Expected<JointAnswer> Run(const JointState& start) {
    answer_.minimum.state = start;
    SEXTANT_RETURN_IF_ERROR(FollowLosses());
    if (options_.cut > 0.0) SEXTANT_RETURN_IF_ERROR(Cut());
    answer_.noise = NoiseOf(Residuals());
    return std::move(answer_);
  }

 private:
  std::vector<BoardViewResiduals> Residuals() const {
    return JointResidualsAt(views_, unknowns_, answer_.minimum.state);
  }

  Expected<void> FollowLosses() {
    const double tolerance = options_.cut > 0.0 ? std::max(options_.step_tolerance, kNearEnough)
                                                : options_.step_tolerance;
    JointNoise noise;
    for (int round = 0; round < kMaxRounds; ++round) {
      const std::vector<BoardViewResiduals> residuals = Residuals();
      const JointNoise now = NoiseOf(residuals);
      JointSelection seen = SelectSeen(residuals);
      DropOneSided(seen);
      if (round > 0 && seen == answer_.selection && IsSame(now, noise)) break;
      noise = now;
      answer_.selection = std::move(seen);
      SEXTANT_RETURN_IF_ERROR(Minimise(LossesOf(options_, noise), tolerance));
    }
    return {};
  }

  Expected<void> Cut() {
    for (int round = 0; round < kMaxRounds; ++round) {
      const std::vector<BoardViewResiduals> residuals = Residuals();
      JointSelection within = SelectWithin(views_, residuals, NoiseOf(residuals), options_.cut);
      DropOneSided(within);
      if (round > 0 && within == answer_.selection) break;
      answer_.selection = std::move(within);
      SEXTANT_RETURN_IF_ERROR(Minimise({}, options_.step_tolerance));
    }
    return {};
  }

  Expected<void> Minimise(const JointLosses& losses, double step_tolerance) {
    if (!AnyView(answer_.selection)) {
      return MakeError(ErrorCode::kDegenerate,
                       "no view has a board that both sensors see at these poses; give views with "
                       "printed points and returns, or a better start");
    }
    answer_.minimum =
        MinimiseJointly(Selected(views_, answer_.selection), unknowns_, losses,
                        answer_.minimum.state, options_.max_iterations, step_tolerance);
    answer_.iterations += answer_.minimum.iterations;
    if (answer_.minimum.converged) return {};
    return MakeError(
        ErrorCode::kNoConvergence,
        fmt::format("no convergence within {} iterations; raise max_iterations, or wrap the inner "
                    "solver in gnc for a better start",
                    options_.max_iterations));
  }

  const std::vector<JointView>& views_;
  const JointUnknowns& unknowns_;
  const JointOptions& options_;
  JointAnswer answer_;
};

}  // namespace

Expected<JointAnswer> SearchJointly(const std::vector<JointView>& views,
                                    const JointUnknowns& unknowns, const JointState& start,
                                    const JointOptions& options) {
  return JointSearch(views, unknowns, options).Run(start);
}

}  // namespace sextant
