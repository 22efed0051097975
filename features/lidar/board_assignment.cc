// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/board_assignment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "features/lidar/board_agreement.h"

namespace sextant {
namespace {

constexpr std::size_t kNoProposal = std::numeric_limits<std::size_t>::max();
constexpr double kSameSize_m = 0.03;  // Boards closer in size are distinguished by their order.

class Assignment {
 public:
  Assignment(const ScanRings& scan, std::span<const Board> boards,
             std::vector<PatchProposal> proposals, BoardSearch& search)
      : scan_(scan), boards_(boards), proposals_(std::move(proposals)), search_(search) {}

  void Run() {
    for (PatchProposal& proposal : proposals_) std::ranges::sort(proposal, {}, Disagreement);
    std::ranges::stable_sort(proposals_, {}, [](const PatchProposal& proposal) {
      return Disagreement(proposal.front());
    });
    DropDuplicates();
    owner_.assign(boards_.size(), kNoProposal);
    for (std::size_t p = 0; p < proposals_.size(); ++p) {
      std::vector<bool> visited(boards_.size(), false);
      if (!Assign(p, visited)) search_.others.push_back(proposals_[p].front());
    }
    for (std::size_t b = 0; b < boards_.size(); ++b) {
      if (owner_[b] == kNoProposal) continue;
      for (const BoardPatch& patch : proposals_[owner_[b]]) {
        if (patch.board == static_cast<int>(b)) search_.found.push_back(patch);
      }
    }
    OrderFromLeft();
    std::ranges::sort(search_.found, {}, &BoardPatch::board);
  }

 private:
  void DropDuplicates() {
    std::vector<PatchProposal> kept;
    for (PatchProposal& proposal : proposals_) {
      const BoardPatch& patch = proposal.front();
      const Eigen::Vector3d center = patch.plane.At(patch.fit.center);
      const Board& board = boards_[static_cast<std::size_t>(patch.board)];
      const double reach = 0.5 * std::hypot(board.top_right_m, board.right_bottom_m);
      const bool is_known = std::ranges::any_of(kept, [&](const PatchProposal& other) {
        return (other.front().plane.At(other.front().fit.center) - center).norm() < reach;
      });
      if (!is_known) kept.push_back(std::move(proposal));
    }
    proposals_ = std::move(kept);
  }

  // Assigns a board to the proposal, reassigning others if necessary.
  bool Assign(std::size_t proposal, std::vector<bool>& visited) {
    for (const BoardPatch& patch : proposals_[proposal]) {
      const auto board = static_cast<std::size_t>(patch.board);
      if (visited[board]) continue;
      visited[board] = true;
      if (owner_[board] == kNoProposal || Assign(owner_[board], visited)) {
        owner_[board] = proposal;
        return true;
      }
    }
    return false;
  }

  bool SameSize(int a, int b) const {
    const Board& first = boards_[static_cast<std::size_t>(a)];
    const Board& second = boards_[static_cast<std::size_t>(b)];
    return std::abs(first.top_right_m - second.top_right_m) < kSameSize_m &&
           std::abs(first.right_bottom_m - second.right_bottom_m) < kSameSize_m &&
           first.hole.has_value() == second.hole.has_value() &&
           first.round_holes.size() == second.round_holes.size();
  }

  // Refits patches whose board changes.
  void OrderFromLeft() {
    std::vector<BoardPatch>& found = search_.found;
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (std::size_t j = i + 1; j < found.size(); ++j) {
        BoardPatch& a = found[i];
        BoardPatch& b = found[j];
        if (!SameSize(a.board, b.board)) continue;
        // The left one has the larger azimuth.
        const bool a_is_left = scan_.axis().dot(a.plane.origin.cross(b.plane.origin)) < 0.0;
        if (a_is_left == (a.board < b.board)) continue;
        std::swap(a.board, b.board);
        Refit(a);
        Refit(b);
      }
    }
  }

  void Refit(BoardPatch& patch) const {
    const Board& board = boards_[static_cast<std::size_t>(patch.board)];
    const Eigen::Vector3d placed(patch.fit.center.x(), patch.fit.center.y(), patch.fit.angle_rad);
    const std::optional<RectangleFit> fit = FitRectangle(patch.edges, board, {&placed, 1});
    if (!fit) return;
    patch.fit = *fit;
    patch.agreement = AgreementOf(scan_, patch, board);
  }

  const ScanRings& scan_;
  std::span<const Board> boards_;
  std::vector<PatchProposal> proposals_;
  BoardSearch& search_;
  std::vector<std::size_t> owner_;  // For each board, its proposal.
};

}  // namespace

double Disagreement(const BoardPatch& patch) {
  const auto edges = static_cast<double>(patch.edges.size());
  const BoardAgreement& agreement = patch.agreement;
  double open = 0.0;
  for (const double side : agreement.open) open += side;
  return (patch.fit.rms + 4.0 * (1.0 - patch.fit.share) + 2.0 * (1.0 - agreement.filled) +
          4.0 * agreement.continued + 2.0 * (kCornersPerBoard - open)) /
         std::sqrt(edges);
}

void AssignBoards(const ScanRings& scan, std::span<const Board> boards,
                  std::vector<PatchProposal> proposals, BoardSearch& search) {
  Assignment(scan, boards, std::move(proposals), search).Run();
}

}  // namespace sextant
