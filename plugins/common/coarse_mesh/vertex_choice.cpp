// SPDX-License-Identifier: Apache-2.0
#include "vertex_choice.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::coarse_mesh {
namespace {

constexpr double kCornerRad = 0.7;  // a border that turns by more at a vertex has a corner there
constexpr double kCornerGap = 0.3;  // share of the wanted distance; a ragged border has corners all
                                    // over
constexpr double kLeastGap = 0.3;   // share of it, inside
constexpr int kRelaxations = 4;

using Mark = std::vector<std::uint8_t>;

/// Distance of neighbours in a hexagonal pattern of `count` points on a mesh and its border: area
/// / (sqrt(3) / 2 distance^2) + border / (2 distance) + 1 = count.
double wanted_distance(const Points2View& places, const FacesView& faces,
                       const MeshTopology& topology, Eigen::Index count) {
  double area = 0.0, border = 0.0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::RowVector2d a = places.row(faces(f, 1)) - places.row(faces(f, 0));
    const Eigen::RowVector2d b = places.row(faces(f, 2)) - places.row(faces(f, 0));
    area += 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
  }
  for (const std::int32_t e : topology.boundary_edges) {
    border += (places.row(topology.edges(e, 0)) - places.row(topology.edges(e, 1))).norm();
  }
  const double squares = 2.0 / std::sqrt(3.0) * area, half = 0.5 * border;
  const double inverse =
      (std::sqrt(half * half + 4.0 * squares * (static_cast<double>(count) - 1.0)) - half) /
      (2.0 * squares);
  return 1.0 / inverse;
}

/// The vertices of each border, in their order along it. Where two borders touch, one ends.
std::vector<std::vector<std::int32_t>> border_loops(const MeshTopology& topology,
                                                    std::size_t vertex_count, Mark& chosen) {
  std::vector<std::vector<std::int32_t>> joined(vertex_count);
  for (const std::int32_t e : topology.boundary_edges) {
    joined[to_index(topology.edges(e, 0))].push_back(topology.edges(e, 1));
    joined[to_index(topology.edges(e, 1))].push_back(topology.edges(e, 0));
  }
  Mark visited(vertex_count, 0);
  std::vector<std::vector<std::int32_t>> loops;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    if (joined[v].size() > 2) chosen[v] = visited[v] = 1;
  }
  for (std::size_t start = 0; start < vertex_count; ++start) {
    if (joined[start].empty() || visited[start] != 0) continue;
    std::vector<std::int32_t> loop;
    for (auto v = static_cast<std::int32_t>(start); v >= 0;) {
      visited[to_index(v)] = 1;
      loop.push_back(v);
      std::int32_t next = -1;
      for (const std::int32_t w : joined[to_index(v)]) {
        if (visited[to_index(w)] == 0) next = w;
      }
      v = next;
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

/// The angle by which a loop turns at each of its vertices, in rad, 0 to pi.
std::vector<double> turns_rad(const Points2View& places, const std::vector<std::int32_t>& loop) {
  std::vector<double> turns;
  const std::size_t n = loop.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Eigen::RowVector2d in = places.row(loop[k]) - places.row(loop[(k + n - 1) % n]);
    const Eigen::RowVector2d out = places.row(loop[(k + 1) % n]) - places.row(loop[k]);
    turns.push_back(std::abs(std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out))));
  }
  return turns;
}

/// Places in the loop, ascending: its corners, the sharpest first, none next to a sharper one.
std::vector<std::size_t> corners_of(const Points2View& places,
                                    const std::vector<std::int32_t>& loop, double gap) {
  const std::vector<double> turns = turns_rad(places, loop);
  std::vector<std::size_t> order, corners;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    if (turns[k] > kCornerRad) order.push_back(k);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return turns[a] > turns[b]; });
  for (const std::size_t k : order) {
    worked(static_cast<std::int64_t>(corners.size()));
    const bool is_far = std::all_of(corners.begin(), corners.end(), [&](std::size_t other) {
      return (places.row(loop[k]) - places.row(loop[other])).norm() >= gap;
    });
    if (is_far) corners.push_back(k);
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Marks the vertices of a loop that divide each stretch between corners into equal parts.
void choose_on_loop(const Points2View& places, const std::vector<std::int32_t>& loop,
                    double distance, Mark& chosen) {
  std::vector<std::size_t> ends = corners_of(places, loop, kCornerGap * distance);
  const std::size_t n = loop.size(), fewest = ends.empty() ? 3 : ends.size() < 3 ? 2 : 1;
  if (ends.empty()) ends.push_back(0);
  for (std::size_t c = 0; c < ends.size(); ++c) {
    const std::size_t first = ends[c];
    const std::size_t last = c + 1 < ends.size() ? ends[c + 1] : ends[0] + n;
    std::vector<double> along{0.0};
    for (std::size_t k = first; k < last; ++k) {
      along.push_back(along.back() +
                      (places.row(loop[(k + 1) % n]) - places.row(loop[k % n])).norm());
    }
    const double length = along.back();
    const auto parts = std::max(fewest, to_index(std::lround(length / distance)));
    std::size_t k = 0;
    for (std::size_t part = 0; part < parts; ++part) {
      const double wanted = length * static_cast<double>(part) / static_cast<double>(parts);
      while (k + 1 < along.size() && std::abs(along[k + 1] - wanted) <= std::abs(along[k] - wanted))
        ++k;
      chosen[to_index(loop[(first + k) % n])] = 1;
    }
  }
}

/// How far each vertex is from those that are chosen, squared; 0 where it cannot be.
class Gaps {
 public:
  Gaps(const Points2View& places, const Mark& chosen, const Mark& may_be_chosen)
      : places_(places), gap2_(chosen.size(), std::numeric_limits<double>::infinity()) {
    for (std::size_t v = 0; v < chosen.size(); ++v) {
      if (chosen[v] != 0) add(v);
    }
    for (std::size_t v = 0; v < chosen.size(); ++v) {
      if (may_be_chosen[v] == 0) gap2_[v] = 0.0;
    }
  }
  void add(std::size_t chosen) {
    worked(places_.rows() / 4);
    const Eigen::RowVector2d place = places_.row(static_cast<Eigen::Index>(chosen));
    for (std::size_t v = 0; v < gap2_.size(); ++v) {
      const double gap2 = (places_.row(static_cast<Eigen::Index>(v)) - place).squaredNorm();
      gap2_[v] = std::min(gap2_[v], gap2);
    }
  }
  std::size_t furthest() const {
    return to_index(std::max_element(gap2_.begin(), gap2_.end()) - gap2_.begin());
  }
  double gap2(std::size_t v) const { return gap2_[v]; }

 private:
  Points2View places_;
  std::vector<double> gap2_;
};

/// Moves the chosen vertices inside to the middle of the vertices that are nearest to them.
void spread_evenly(const Points2View& places, const Mark& inside, Mark& chosen) {
  std::vector<std::size_t> centres;
  for (std::size_t v = 0; v < chosen.size(); ++v) {
    if (chosen[v] != 0) centres.push_back(v);
  }
  std::vector<std::size_t> nearest(chosen.size());
  Points2 sums = Points2::Zero(static_cast<Eigen::Index>(centres.size()), 2);
  std::vector<double> counts(centres.size(), 0.0);
  for (std::size_t v = 0; v < chosen.size(); ++v) {
    worked(static_cast<std::int64_t>(centres.size()) / 4);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < centres.size(); ++c) {
      const double gap2 = (places.row(static_cast<Eigen::Index>(v)) -
                           places.row(static_cast<Eigen::Index>(centres[c])))
                              .squaredNorm();
      if (gap2 < least) least = gap2, nearest[v] = c;
    }
    sums.row(static_cast<Eigen::Index>(nearest[v])) += places.row(static_cast<Eigen::Index>(v));
    counts[nearest[v]] += 1.0;
  }
  std::vector<std::size_t> moved = centres;
  std::vector<double> least(centres.size(), std::numeric_limits<double>::infinity());
  for (std::size_t v = 0; v < chosen.size(); ++v) {
    const std::size_t c = nearest[v];
    if (inside[v] == 0 || inside[centres[c]] == 0) continue;
    const double gap2 = (places.row(static_cast<Eigen::Index>(v)) -
                         sums.row(static_cast<Eigen::Index>(c)) / counts[c])
                            .squaredNorm();
    if (gap2 < least[c]) least[c] = gap2, moved[c] = v;
  }
  for (const std::size_t v : centres) chosen[v] = 0;
  for (const std::size_t v : moved) chosen[v] = 1;
}

}  // namespace

std::vector<std::uint8_t> choose_vertices(const Points2View& places, const FacesView& faces,
                                          const MeshTopology& topology, Eigen::Index count) {
  const auto vertex_count = to_index(places.rows());
  Mark chosen(vertex_count, 1), inside(vertex_count, 0);
  for (const std::int32_t v : faces.reshaped()) {
    chosen[to_index(v)] = 0;
    inside[to_index(v)] = 1;
  }
  for (const std::int32_t e : topology.boundary_edges) {
    for (const int end : {0, 1}) inside[to_index(topology.edges(e, end))] = 0;
  }
  const double distance = wanted_distance(places, faces, topology, count);
  for (const auto& loop : border_loops(topology, vertex_count, chosen)) {
    choose_on_loop(places, loop, distance, chosen);
  }
  Gaps gaps(places, chosen, inside);
  auto left = count - std::count(chosen.begin(), chosen.end(), 1);
  for (; left > 0; --left) {
    const std::size_t v = gaps.furthest();
    if (!(gaps.gap2(v) > std::pow(kLeastGap * distance, 2))) break;
    chosen[v] = 1;
    gaps.add(v);
  }
  for (int k = 0; k < kRelaxations; ++k) spread_evenly(places, inside, chosen);
  return chosen;
}

}  // namespace weft::coarse_mesh
