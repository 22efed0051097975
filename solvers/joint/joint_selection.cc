// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_selection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/median.h"

namespace sextant {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
// Median of the absolute value of a standard normal variable.
constexpr double kNormalMedian = 0.6744897501960817;

BoardViewResiduals ResidualsOfView(const JointView& view, const JointUnknowns& unknowns,
                                   const JointState& state, const Rigid3d& cam_from_board) {
  BoardViewResiduals residuals;
  PrintedResidual printed;
  for (const PrintedTerm& term : view.terms.printed) {
    const bool seen = Differentiate(term, state.camera, cam_from_board, printed);
    residuals.printed.push_back(
        seen ? printed.value.norm() / std::sqrt(static_cast<double>(printed.value.size())) : kNone);
  }
  const BoardPlane plane(state.cam_from_lidar.Inverse() * cam_from_board);
  const JointRayModel model(view, unknowns, state);
  JointRay ray;
  for (const FaceTerm& term : view.terms.face) {
    residuals.face.push_back(model.Differentiate(term, plane, ray) ? ray.residual.value : kNone);
  }
  for (const EdgeTerm& term : view.terms.edges) {
    residuals.edges.push_back(model.Differentiate(term, plane, ray) ? ray.residual.value : kNone);
  }
  return residuals;
}

template <class Term>
std::vector<Term> Keep(const std::vector<Term>& terms, const std::vector<bool>& chosen) {
  std::vector<Term> kept;
  kept.reserve(terms.size());
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (chosen[i]) kept.push_back(terms[i]);
  }
  return kept;
}

std::vector<bool> Within(const std::vector<double>& residuals, double limit) {
  std::vector<bool> within;
  within.reserve(residuals.size());
  for (const double value : residuals) within.push_back(std::abs(value) < limit);
  return within;
}

}  // namespace

std::vector<BoardViewResiduals> JointResidualsAt(const std::vector<JointView>& views,
                                                 const JointUnknowns& unknowns,
                                                 const JointState& state) {
  std::vector<BoardViewResiduals> residuals;
  residuals.reserve(views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    residuals.push_back(ResidualsOfView(views[i], unknowns, state, state.cam_from_board[i]));
  }
  return residuals;
}

JointNoise NoiseOf(const std::vector<BoardViewResiduals>& residuals) {
  std::vector<double> printed;
  std::vector<double> face;
  std::vector<double> edges;
  const auto add = [](const std::vector<double>& values, std::vector<double>& to) {
    for (const double value : values) to.push_back(std::abs(value));
  };
  for (const BoardViewResiduals& of : residuals) {
    add(of.printed, printed);
    add(of.face, face);
    add(of.edges, edges);
  }
  const auto at_least_stated = [](double ratio) {
    return std::isfinite(ratio) ? std::max(1.0, ratio) : 1.0;
  };
  return {at_least_stated(UpperMedian(printed)), at_least_stated(UpperMedian(face) / kNormalMedian),
          at_least_stated(UpperMedian(edges) / kNormalMedian)};
}

JointSelection SelectSeen(const std::vector<BoardViewResiduals>& residuals) {
  JointSelection selection;
  for (const BoardViewResiduals& of : residuals) {
    selection.push_back(
        {Within(of.printed, kNone), Within(of.face, kNone), Within(of.edges, kNone)});
  }
  return selection;
}

JointSelection SelectWithin(const std::vector<JointView>& views,
                            const std::vector<BoardViewResiduals>& residuals,
                            const JointNoise& noise, double sigmas) {
  JointSelection selection;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const BoardViewResiduals& of = residuals[i];
    JointViewSelection chosen{
        {}, Within(of.face, sigmas * noise.face), Within(of.edges, sigmas * noise.edges)};
    for (std::size_t k = 0; k < of.printed.size(); ++k) {
      const std::size_t points = views[i].terms.printed[k].pixels.size();
      const double limit =
          PrintedLimit(points, sigmas) / std::sqrt(2.0 * static_cast<double>(points));
      chosen.printed.push_back(of.printed[k] < limit * noise.printed);
    }
    selection.push_back(std::move(chosen));
  }
  return selection;
}

std::vector<JointView> Selected(const std::vector<JointView>& views,
                                const JointSelection& selection) {
  std::vector<JointView> selected;
  selected.reserve(views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    const BoardViewTerms& terms = views[i].terms;
    selected.push_back(
        {{Keep(terms.printed, selection[i].printed), Keep(terms.face, selection[i].face),
          Keep(terms.edges, selection[i].edges)},
         views[i].sized_board});
  }
  return selected;
}

}  // namespace sextant
