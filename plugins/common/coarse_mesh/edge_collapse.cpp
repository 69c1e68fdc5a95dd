// SPDX-License-Identifier: Apache-2.0
#include "edge_collapse.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::coarse_mesh {
namespace {

constexpr double kLeastQuality = 1e-3;  // a needle; twice the area over the longest side squared
constexpr double kNotDelaunay = -1e-9;  // sum of cotangents; squares are left as they are
constexpr int kMostSweeps = 20;

using Triangle = std::array<std::int32_t, 3>;
using IndexList = std::vector<std::int32_t>;

bool has(const Triangle& face, std::int32_t v) {
  return face[0] == v || face[1] == v || face[2] == v;
}

/// A flat mesh from which vertices are removed.
class Collapse {
 public:
  Collapse(const Points2View& places, const FacesView& faces)
      : places_(places), around_(to_index(places.rows())) {
    double area2 = 0.0;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      faces_.push_back({faces(f, 0), faces(f, 1), faces(f, 2)});
      for (const std::int32_t v : faces_.back()) {
        around_[to_index(v)].push_back(static_cast<std::int32_t>(f));
      }
      area2 += cross(faces_.back());
    }
    turn_ = area2 < 0.0 ? -1.0 : 1.0;
  }

  /// Takes out vertices that are not next to each other, as many as can be. Returns their number.
  int thin_out(const std::vector<std::uint8_t>& keep) {
    std::vector<std::uint8_t> resting(around_.size(), 0);
    int removed = 0;
    for (std::size_t v = 0; v < around_.size(); ++v) {
      if (keep[v] != 0 || resting[v] != 0 || around_[v].empty()) continue;
      const IndexList neighbours = neighbours_of(static_cast<std::int32_t>(v));
      if (!take_out(static_cast<std::int32_t>(v), neighbours)) continue;
      ++removed;
      for (const std::int32_t w : neighbours) resting[to_index(w)] = 1;
    }
    return removed;
  }

  void flip_to_delaunay() {
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      int flipped = 0;
      for (std::size_t f = 0; f < faces_.size(); ++f) {
        worked(5);
        for (std::size_t k = 0; k < 3 && faces_[f][0] >= 0; ++k) flipped += flip(f, k) ? 1 : 0;
      }
      if (flipped == 0) return;
    }
  }

  ThinMesh result(const std::vector<std::uint8_t>& keep) const {
    ThinMesh mesh;
    IndexList index(around_.size(), -1);
    for (std::size_t v = 0; v < around_.size(); ++v) {
      if (around_[v].empty() && keep[v] == 0) continue;
      index[v] = static_cast<std::int32_t>(mesh.vertices.size());
      mesh.vertices.push_back(static_cast<std::int32_t>(v));
    }
    const auto is_left = [](const Triangle& face) { return face[0] >= 0; };
    mesh.faces.resize(std::count_if(faces_.begin(), faces_.end(), is_left), 3);
    Eigen::Index row = 0;
    for (const Triangle& face : faces_) {
      if (!is_left(face)) continue;
      for (Eigen::Index k = 0; k < 3; ++k) {
        mesh.faces(row, k) = index[to_index(face[to_index(k)])];
      }
      ++row;
    }
    return mesh;
  }

 private:
  double cross(const Triangle& face) const {
    const Eigen::RowVector2d a = places_.row(face[1]) - places_.row(face[0]);
    const Eigen::RowVector2d b = places_.row(face[2]) - places_.row(face[0]);
    return a.x() * b.y() - a.y() * b.x();
  }

  /// Positive where the face is turned as it should be; 0.87 for an equilateral one.
  double quality(const Triangle& face) const {
    double longest2 = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::RowVector2d side = places_.row(face[(k + 1) % 3]) - places_.row(face[k]);
      longest2 = std::max(longest2, side.squaredNorm());
    }
    return longest2 > 0.0 ? turn_ * cross(face) / longest2 : 0.0;
  }

  const Triangle& face(std::int32_t f) const { return faces_[to_index(f)]; }

  IndexList neighbours_of(std::int32_t v) const {
    IndexList neighbours;
    for (const std::int32_t f : around_[to_index(v)]) {
      for (const std::int32_t w : face(f)) {
        if (w != v) neighbours.push_back(w);
      }
    }
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
    return neighbours;
  }

  std::ptrdiff_t faces_shared(std::int32_t v, std::int32_t w) const {
    const IndexList& around = around_[to_index(v)];
    return std::count_if(around.begin(), around.end(),
                         [&](std::int32_t f) { return has(face(f), w); });
  }

  /// Moves v onto the neighbour that leaves the best triangles; false where none can be.
  bool take_out(std::int32_t v, const IndexList& neighbours) {
    worked(static_cast<std::int64_t>(20 * neighbours.size()));
    const bool on_border = std::any_of(neighbours.begin(), neighbours.end(),
                                       [&](std::int32_t w) { return faces_shared(v, w) == 1; });
    std::int32_t best = -1;
    double most = kLeastQuality;
    for (const std::int32_t w : neighbours) {
      const auto shared = faces_shared(v, w);
      if (shared != (on_border ? 1 : 2)) continue;  // vertices on the border stay on it
      const IndexList others = neighbours_of(w);
      IndexList common;
      std::set_intersection(neighbours.begin(), neighbours.end(), others.begin(), others.end(),
                            std::back_inserter(common));
      if (static_cast<std::ptrdiff_t>(common.size()) != shared) continue;  // else not manifold
      const double worst = worst_without(v, w);
      if (worst > most) most = worst, best = w;
    }
    if (best >= 0) move_onto(v, best);
    return best >= 0;
  }

  /// The least quality of the faces that v has when it is where w is; 0 where none is left.
  double worst_without(std::int32_t v, std::int32_t w) const {
    double worst = 1.0;
    bool any = false;
    for (const std::int32_t f : around_[to_index(v)]) {
      Triangle moved = face(f);
      if (has(moved, w)) continue;
      std::replace(moved.begin(), moved.end(), v, w);
      worst = std::min(worst, quality(moved));
      any = true;
    }
    return any ? worst : 0.0;
  }

  void drop(std::int32_t v, std::int32_t f) {
    IndexList& around = around_[to_index(v)];
    around.erase(std::find(around.begin(), around.end(), f));
  }

  void move_onto(std::int32_t v, std::int32_t w) {
    const IndexList around = around_[to_index(v)];
    around_[to_index(v)].clear();
    for (const std::int32_t f : around) {
      Triangle& moved = faces_[to_index(f)];
      if (has(moved, w)) {
        for (const std::int32_t other : moved) {
          if (other != v) drop(other, f);
        }
        moved = {-1, -1, -1};
      } else {
        std::replace(moved.begin(), moved.end(), v, w);
        around_[to_index(w)].push_back(f);
      }
    }
  }

  double cotangent_at(std::int32_t apex, std::int32_t a, std::int32_t b) const {
    const Eigen::RowVector2d to_a = places_.row(a) - places_.row(apex);
    const Eigen::RowVector2d to_b = places_.row(b) - places_.row(apex);
    return to_a.dot(to_b) / (turn_ * (to_a.x() * to_b.y() - to_a.y() * to_b.x()));
  }

  /// Turns the edge k of face f where the angles opposite to it sum to more than half a turn.
  bool flip(std::size_t f, std::size_t k) {
    const std::int32_t a = faces_[f][k], b = faces_[f][(k + 1) % 3], c = faces_[f][(k + 2) % 3];
    const auto first = static_cast<std::int32_t>(f);
    for (const std::int32_t second : around_[to_index(a)]) {
      if (second == first || !has(face(second), b)) continue;
      std::int32_t d = -1;
      for (const std::int32_t v : face(second)) d = v != a && v != b ? v : d;
      if (!(cotangent_at(c, a, b) + cotangent_at(d, b, a) < kNotDelaunay)) return false;
      const Triangle left{a, d, c}, right{d, b, c};
      if (faces_shared(c, d) > 0 || !(quality(left) > 0.0 && quality(right) > 0.0)) return false;
      faces_[f] = left;
      faces_[to_index(second)] = right;
      drop(a, second);
      drop(b, first);
      around_[to_index(c)].push_back(second);
      around_[to_index(d)].push_back(first);
      return true;
    }
    return false;
  }

  Points2View places_;
  std::vector<Triangle> faces_;    ///< -1 where there is none left
  std::vector<IndexList> around_;  ///< [V] faces around each vertex
  double turn_ = 1.0;              ///< sign of the area of a face
};

}  // namespace

ThinMesh thin_mesh(const Points2View& places, const FacesView& faces,
                   const std::vector<std::uint8_t>& keep) {
  Collapse mesh(places, faces);
  while (mesh.thin_out(keep) > 0) mesh.flip_to_delaunay();
  return mesh.result(keep);
}

}  // namespace weft::coarse_mesh
