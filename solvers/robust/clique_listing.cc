// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/clique_listing.h"

#include <deque>
#include <utility>

namespace sextant {
namespace {

using Bits = std::vector<std::uint64_t>;

/// The cliques of at least a given size.
class CliqueListing {
 public:
  CliqueListing(const BitGraph& graph, std::size_t min_size, std::size_t max_cliques,
                std::int64_t max_nodes)
      : graph_(graph), min_size_(min_size), max_cliques_(max_cliques), max_nodes_(max_nodes) {}

  std::vector<std::vector<int>> Run() {
    Bits& all = CandidatesAt(0);
    for (int v = 0; v < graph_.vertices(); ++v) all[WordOf(v)] |= BitOf(v);
    Extend(0);
    return std::move(found_);
  }

 private:
  Bits& CandidatesAt(std::size_t depth) {
    while (candidates_.size() <= depth) candidates_.emplace_back(graph_.words(), 0);
    return candidates_[depth];
  }

  void Extend(std::size_t depth) {
    ++nodes_;
    if (current_.size() >= min_size_) found_.push_back(current_);
    Bits& candidates = CandidatesAt(depth);
    Bits& next = CandidatesAt(depth + 1);
    for (std::size_t w = 0; w < candidates.size(); ++w) {
      while (candidates[w] != 0) {
        if (found_.size() >= max_cliques_ || nodes_ >= max_nodes_) return;
        const int v = static_cast<int>(w) * kWordBits + std::countr_zero(candidates[w]);
        candidates[w] &= candidates[w] - 1;
        const int left =
            Intersect(candidates.data(), graph_.Row(v), candidates.size(), next.data());
        if (current_.size() + 1 + static_cast<std::size_t>(left) < min_size_) continue;
        current_.push_back(v);
        Extend(depth + 1);
        current_.pop_back();
      }
    }
  }

  const BitGraph& graph_;
  std::size_t min_size_;
  std::size_t max_cliques_;
  std::int64_t max_nodes_;
  std::int64_t nodes_ = 0;
  std::deque<Bits> candidates_;  // By depth of the search.
  std::vector<int> current_;
  std::vector<std::vector<int>> found_;
};

}  // namespace

std::vector<std::vector<int>> ListCliques(const BitGraph& graph, std::size_t min_size,
                                          std::size_t max_cliques, std::int64_t max_nodes) {
  return CliqueListing(graph, min_size, max_cliques, max_nodes).Run();
}

}  // namespace sextant
