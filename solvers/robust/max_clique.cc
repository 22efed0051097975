// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/max_clique.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <deque>
#include <numeric>
#include <utility>

namespace sextant {
namespace {

using Bits = std::vector<std::uint64_t>;

// Vertices by falling degree, and ascending among those of equal degree.
std::vector<int> ByFallingDegree(const std::vector<int>& degrees) {
  // Allocated first: g++ 14 otherwise warns of the size that it infers where `begins` is empty.
  std::vector<int> order(degrees.size());
  std::vector<int> begins(degrees.size() + 1, 0);
  for (const int degree : degrees) ++begins[static_cast<std::size_t>(degree)];
  int begin = 0;
  std::for_each(begins.rbegin(), begins.rend(),
                [&](int& count) { begin += std::exchange(count, begin); });
  for (std::size_t v = 0; v < degrees.size(); ++v) {
    int& place = begins[static_cast<std::size_t>(degrees[v])];
    order[static_cast<std::size_t>(place++)] = static_cast<int>(v);
  }
  return order;
}

// The largest of several greedy cliques: each starts at one of the vertices with the highest degree
// and adds vertices by falling degree.
std::vector<int> GreedyClique(const BitGraph& graph, const std::vector<int>& degrees) {
  constexpr std::size_t kStarts = 4;
  const std::vector<int> order = ByFallingDegree(degrees);
  std::vector<int> best;
  std::vector<int> clique;
  Bits candidates(graph.words());
  for (std::size_t start = 0; start < std::min(kStarts, order.size()); ++start) {
    clique.clear();
    const auto add = [&](int v) {
      clique.push_back(v);
      const std::uint64_t* row = graph.Row(v);
      for (std::size_t w = 0; w < candidates.size(); ++w) candidates[w] &= row[w];
    };
    std::fill(candidates.begin(), candidates.end(), ~std::uint64_t{0});
    add(order[start]);
    for (const int v : order) {
      if ((candidates[WordOf(v)] & BitOf(v)) != 0) add(v);
    }
    if (clique.size() > best.size()) best = clique;
  }
  return best;
}

// The k-core with k = min_degree, ascending: each of its vertices has at least min_degree
// neighbours in it.
std::vector<int> CoreOf(const BitGraph& graph, std::vector<int> degrees, int min_degree) {
  std::vector<int> removed;
  const auto is_low = [&](int v) { return degrees[static_cast<std::size_t>(v)] < min_degree; };
  for (int v = 0; v < graph.vertices(); ++v) {
    if (is_low(v)) removed.push_back(v);
  }
  for (std::size_t next = 0; next < removed.size(); ++next) {
    ForEachBit(graph.Row(removed[next]), graph.words(), [&](int v) {
      if (degrees[static_cast<std::size_t>(v)]-- == min_degree) removed.push_back(v);
    });
  }
  std::vector<int> core;
  for (int v = 0; v < graph.vertices(); ++v) {
    if (!is_low(v)) core.push_back(v);
  }
  return core;
}

BitGraph Subgraph(const BitGraph& graph, const std::vector<int>& vertices) {
  constexpr int kNowhere = -1;
  std::vector<int> places(static_cast<std::size_t>(graph.vertices()), kNowhere);
  for (std::size_t place = 0; place < vertices.size(); ++place) {
    places[static_cast<std::size_t>(vertices[place])] = static_cast<int>(place);
  }
  BitGraph sub(static_cast<int>(vertices.size()));
  for (const int v : vertices) {
    std::uint64_t* row = sub.Row(places[static_cast<std::size_t>(v)]);
    ForEachBit(graph.Row(v), graph.words(), [&](int neighbour) {
      const int place = places[static_cast<std::size_t>(neighbour)];
      if (place != kNowhere) row[WordOf(place)] |= BitOf(place);
    });
  }
  return sub;
}

// Degeneracy order reversed: repeatedly removes the vertex with the fewest neighbours. Colouring
// then starts with the best connected vertices.
std::vector<int> DegeneracyOrder(const BitGraph& graph) {
  std::vector<int> degrees = DegreesOf(graph);
  std::vector<int> left(degrees.size());
  std::iota(left.begin(), left.end(), 0);
  std::vector<int> order;
  while (!left.empty()) {
    const auto next = std::min_element(left.begin(), left.end(), [&](int a, int b) {
      return degrees[static_cast<std::size_t>(a)] < degrees[static_cast<std::size_t>(b)];
    });
    const int removed = *next;
    left.erase(next);
    order.push_back(removed);
    ForEachBit(graph.Row(removed), graph.words(),
               [&](int v) { --degrees[static_cast<std::size_t>(v)]; });
  }
  std::reverse(order.begin(), order.end());
  return order;
}

// The colouring of a node takes time as the square of the vertices: as much in all as for 1000.
std::int64_t NodesFor(std::size_t vertices, std::int64_t max_nodes) {
  constexpr double kVertices = 1000.0;
  const double share = std::min(1.0, kVertices / static_cast<double>(vertices));
  return std::max<std::int64_t>(1, std::llround(share * share * static_cast<double>(max_nodes)));
}

/// Searches for a clique larger than a known size.
class CliqueSearch {
 public:
  CliqueSearch(const BitGraph& graph, std::size_t known, std::int64_t max_nodes)
      : max_nodes_(max_nodes),
        order_(DegeneracyOrder(graph)),
        sorted_(Subgraph(graph, order_)),
        largest_(known) {}

  void Run() {
    Level& root = LevelAt(0);
    for (int v = 0; v < sorted_.vertices(); ++v) root.candidates[WordOf(v)] |= BitOf(v);
    Expand(0);
  }

  bool is_maximum() const { return nodes_ < max_nodes_; }
  std::int64_t nodes() const { return nodes_; }
  /// Vertices of the given graph; empty where no clique is larger than the known size.
  std::vector<int> best() const {
    std::vector<int> vertices;
    for (const int v : best_) vertices.push_back(order_[static_cast<std::size_t>(v)]);
    return vertices;
  }

 private:
  // A candidate and the number of colours used for it and the candidates before it.
  struct Coloured {
    int vertex;
    int colours;
  };

  // Buffers of one depth of the search, reused by its nodes.
  struct Level {
    Bits candidates;
    std::vector<Coloured> coloured;
  };

  Level& LevelAt(std::size_t depth) {
    // A deque does not move its elements when it grows.
    while (levels_.size() <= depth) levels_.push_back({Bits(sorted_.words(), 0), {}});
    return levels_[depth];
  }

  // Lists candidates by rising colour, without those that cannot lead to a larger clique.
  void Colour(Level& level) {
    level.coloured.clear();
    const int max_useless = static_cast<int>(largest_) - static_cast<int>(current_.size());
    uncoloured_ = level.candidates;
    for (int colour = 1; AnyOf(uncoloured_); ++colour) {
      same_colour_ = uncoloured_;
      for (std::size_t w = 0; w < same_colour_.size(); ++w) {
        while (same_colour_[w] != 0) {
          const int v = static_cast<int>(w) * kWordBits + std::countr_zero(same_colour_[w]);
          uncoloured_[w] &= ~BitOf(v);
          same_colour_[w] &= ~BitOf(v);
          const std::uint64_t* row = sorted_.Row(v);
          for (std::size_t k = w; k < same_colour_.size(); ++k) same_colour_[k] &= ~row[k];
          if (colour > max_useless) level.coloured.push_back({v, colour});
        }
      }
    }
  }

  void Expand(std::size_t depth) {
    ++nodes_;
    if (current_.size() > largest_) {
      best_ = current_;
      largest_ = best_.size();
    }
    Level& level = LevelAt(depth);
    Level& next = LevelAt(depth + 1);
    Colour(level);
    for (auto branch = level.coloured.rbegin(); branch != level.coloured.rend(); ++branch) {
      if (nodes_ >= max_nodes_) return;
      if (current_.size() + static_cast<std::size_t>(branch->colours) <= largest_) return;
      const int candidates = Intersect(level.candidates.data(), sorted_.Row(branch->vertex),
                                       sorted_.words(), next.candidates.data());
      current_.push_back(branch->vertex);
      if (current_.size() + static_cast<std::size_t>(candidates) > largest_) Expand(depth + 1);
      current_.pop_back();
      level.candidates[WordOf(branch->vertex)] &= ~BitOf(branch->vertex);
    }
  }

  static bool AnyOf(const Bits& bits) {
    return std::any_of(bits.begin(), bits.end(), [](std::uint64_t word) { return word != 0; });
  }

  std::int64_t max_nodes_;
  std::int64_t nodes_ = 0;
  std::vector<int> order_;  // The vertex of the given graph for each vertex of `sorted_`.
  BitGraph sorted_;
  std::deque<Level> levels_;
  Bits uncoloured_;
  Bits same_colour_;
  std::vector<int> current_;
  std::vector<int> best_;
  std::size_t largest_;
};

}  // namespace

Clique FindMaximumClique(const BitGraph& graph, std::int64_t max_nodes) {
  const std::vector<int> degrees = DegreesOf(graph);
  Clique clique;
  clique.vertices = GreedyClique(graph, degrees);
  const std::vector<int> core = CoreOf(graph, degrees, static_cast<int>(clique.vertices.size()));
  if (!core.empty()) {
    CliqueSearch search(Subgraph(graph, core), clique.vertices.size(),
                        NodesFor(core.size(), max_nodes));
    search.Run();
    clique.is_maximum = search.is_maximum();
    clique.nodes = search.nodes();
    const std::vector<int> larger = search.best();
    if (!larger.empty()) {
      clique.vertices.clear();
      for (const int v : larger) clique.vertices.push_back(core[static_cast<std::size_t>(v)]);
    }
  }
  std::sort(clique.vertices.begin(), clique.vertices.end());
  return clique;
}

}  // namespace sextant
