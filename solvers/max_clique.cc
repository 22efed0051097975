// SPDX-License-Identifier: Apache-2.0
#include "solvers/max_clique.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace sextant {
namespace {

constexpr int kWordBits = 64;

std::size_t WordOf(int vertex) { return static_cast<std::size_t>(vertex) / kWordBits; }
std::uint64_t BitOf(int vertex) { return std::uint64_t{1} << (vertex % kWordBits); }

// Vertices so that each has the fewest neighbours among those after it, then reversed: the search
// meets the best connected ones first in colouring.
std::vector<int> DegeneracyOrder(const BitGraph& graph) {
  const int n = graph.vertices();
  std::vector<int> degree(static_cast<std::size_t>(n), 0);
  for (int v = 0; v < n; ++v) {
    for (std::size_t w = 0; w < graph.words(); ++w) {
      degree[static_cast<std::size_t>(v)] += std::popcount(graph.Row(v)[w]);
    }
  }
  std::vector<int> left(static_cast<std::size_t>(n));
  std::iota(left.begin(), left.end(), 0);
  std::vector<int> order;
  while (!left.empty()) {
    const auto least = std::min_element(left.begin(), left.end(), [&](int a, int b) {
      return degree[static_cast<std::size_t>(a)] < degree[static_cast<std::size_t>(b)];
    });
    const int removed = *least;
    left.erase(least);
    order.push_back(removed);
    for (const int v : left) {
      if (graph.AreConnected(v, removed)) --degree[static_cast<std::size_t>(v)];
    }
  }
  std::reverse(order.begin(), order.end());
  return order;
}

class CliqueSearch {
 public:
  CliqueSearch(const BitGraph& graph, std::int64_t max_nodes)
      : max_nodes_(max_nodes), order_(DegeneracyOrder(graph)), sorted_(graph.vertices()) {
    const int n = graph.vertices();
    for (int a = 0; a < n; ++a) {
      for (int b = 0; b < a; ++b) {
        if (graph.AreConnected(Original(a), Original(b))) sorted_.Connect(a, b);
      }
    }
  }

  Clique Run() {
    Bits all(sorted_.words(), 0);
    for (int v = 0; v < sorted_.vertices(); ++v) all[WordOf(v)] |= BitOf(v);
    Expand(all);
    Clique clique;
    clique.is_maximum = nodes_ < max_nodes_;
    clique.nodes = nodes_;
    for (const int v : best_) clique.vertices.push_back(Original(v));
    std::sort(clique.vertices.begin(), clique.vertices.end());
    return clique;
  }

 private:
  using Bits = std::vector<std::uint64_t>;

  // A candidate and the number of colours that it and the candidates before it need.
  struct Coloured {
    int vertex;
    int colours;
  };

  int Original(int v) const { return order_[static_cast<std::size_t>(v)]; }

  // Candidates by rising colour; those that cannot lead beyond the best are left out.
  std::vector<Coloured> Colour(const Bits& candidates) const {
    std::vector<Coloured> coloured;
    const int useless = static_cast<int>(best_.size()) - static_cast<int>(current_.size());
    Bits uncoloured = candidates;
    Bits same_colour(candidates.size());
    for (int colour = 1; AnyOf(uncoloured); ++colour) {
      same_colour = uncoloured;
      for (std::size_t w = 0; w < same_colour.size(); ++w) {
        while (same_colour[w] != 0) {
          const int v = static_cast<int>(w) * kWordBits + std::countr_zero(same_colour[w]);
          uncoloured[w] &= ~BitOf(v);
          same_colour[w] &= ~BitOf(v);
          const std::uint64_t* row = sorted_.Row(v);
          for (std::size_t k = w; k < same_colour.size(); ++k) same_colour[k] &= ~row[k];
          if (colour > useless) coloured.push_back({v, colour});
        }
      }
    }
    return coloured;
  }

  void Expand(Bits& candidates) {
    ++nodes_;
    if (current_.size() > best_.size()) best_ = current_;
    const std::vector<Coloured> coloured = Colour(candidates);
    Bits next(candidates.size());
    for (auto branch = coloured.rbegin(); branch != coloured.rend(); ++branch) {
      if (nodes_ >= max_nodes_) return;
      if (static_cast<int>(current_.size()) + branch->colours <= static_cast<int>(best_.size())) {
        return;
      }
      const std::uint64_t* row = sorted_.Row(branch->vertex);
      for (std::size_t w = 0; w < next.size(); ++w) next[w] = candidates[w] & row[w];
      current_.push_back(branch->vertex);
      Expand(next);
      current_.pop_back();
      candidates[WordOf(branch->vertex)] &= ~BitOf(branch->vertex);
    }
  }

  static bool AnyOf(const Bits& bits) {
    return std::any_of(bits.begin(), bits.end(), [](std::uint64_t word) { return word != 0; });
  }

  std::int64_t max_nodes_;
  std::int64_t nodes_ = 0;
  std::vector<int> order_;  // Vertex of the given graph at each place of `sorted_`.
  BitGraph sorted_;
  std::vector<int> current_;
  std::vector<int> best_;
};

}  // namespace

BitGraph::BitGraph(int vertices)
    : vertices_(vertices),
      words_((static_cast<std::size_t>(vertices) + kWordBits - 1) / kWordBits),
      bits_(static_cast<std::size_t>(vertices) * words_, 0) {}

void BitGraph::Connect(int a, int b) {
  bits_[static_cast<std::size_t>(a) * words_ + WordOf(b)] |= BitOf(b);
  bits_[static_cast<std::size_t>(b) * words_ + WordOf(a)] |= BitOf(a);
}

void BitGraph::Isolate(int vertex) {
  for (int v = 0; v < vertices_; ++v) {
    bits_[static_cast<std::size_t>(v) * words_ + WordOf(vertex)] &= ~BitOf(vertex);
  }
  std::fill_n(
      bits_.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(vertex) * words_),
      words_, 0);
}

bool BitGraph::AreConnected(int a, int b) const { return (Row(a)[WordOf(b)] & BitOf(b)) != 0; }

Clique FindMaximumClique(const BitGraph& graph, std::int64_t max_nodes) {
  return CliqueSearch(graph, max_nodes).Run();
}

}  // namespace sextant
