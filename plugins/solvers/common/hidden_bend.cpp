// SPDX-License-Identifier: Apache-2.0
#include "hidden_bend.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_bending.hpp>

namespace weft::solvers {
namespace {

constexpr double kReachInEdges = 3.0, kReachInDiagonals = 0.24;  // the larger one
constexpr double kTearingStrain = 0.3;
constexpr double kTornShare = 0.1;     // share of the edges of a part; a noisy rim strains a few
constexpr int kSharpness = 4;          // squarings: 0.1 for edges at an angle of 30 degrees
constexpr double kLeastWeight = 1.0;   // as of one edge next to the rim
constexpr double kLeastSpread = 1e-3;  // squared reaches; a line needs edges at different distances

/// The frame of an edge (a, b) and the face (a, b, c): along it, away from c in the plane of the
/// face, and out of the front.
struct EdgeFrame {
  Eigen::Vector3d along, away, front;
};

EdgeFrame frame_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  EdgeFrame frame;
  frame.along = (b - a).normalized();
  frame.front = (b - a).cross(c - a).normalized();
  frame.away = frame.along.cross(frame.front);
  return frame;
}

/// True if c is left of the way from a to b, as the camera sees the front; v grows downwards.
bool is_left(const Points2& flat_px, std::int32_t a, std::int32_t b, std::int32_t c) {
  const Eigen::RowVector2d to_b = flat_px.row(b) - flat_px.row(a);
  const Eigen::RowVector2d to_c = flat_px.row(c) - flat_px.row(a);
  return to_b.x() * to_c.y() - to_b.y() * to_c.x() < 0.0;
}

bool has(const std::vector<std::uint8_t>& marked, std::int32_t vertex) {
  return marked[to_index(vertex)] != 0;
}

/// How far the surface is bent across an edge that is seen.
struct SeenBend {
  Eigen::Vector2d place_px, across;  ///< texture
  double per_m;                      ///< [] rad/m, against the rest shape
};

/// Keeps every second, third ... so that at most `most` remain.
void keep_evenly(std::vector<SeenBend>& bends, std::size_t most) {
  if (bends.size() <= most) return;
  const std::size_t stride = (bends.size() + most - 1) / most;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < bends.size(); i += stride) bends[kept++] = bends[i];
  bends.resize(kept);
}

/// The bend that those near a place and across a similar direction predict there; nothing where
/// there are too few. It is their mean, limited by the line through them by distance: a bend that
/// fades towards the rim is not continued past 0. One that grows does not grow further.
std::optional<double> expected_bend(const std::vector<SeenBend>& seen,
                                    const Eigen::Vector2d& place_px, const Eigen::Vector2d& across,
                                    double reach_px) {
  double nearest_px = std::numeric_limits<double>::infinity();
  for (const SeenBend& bend : seen) {
    nearest_px = std::min(nearest_px, (bend.place_px - place_px).norm());
  }
  // Sums of the weighted least squares of per_m ~ level + slope distance, in units of the reach.
  double weights = 0.0, far = 0.0, far_squared = 0.0, bends = 0.0, far_bends = 0.0;
  for (const SeenBend& bend : seen) {
    const double distance = (bend.place_px - place_px).norm() / reach_px;
    double likeness = std::abs(bend.across.dot(across));
    for (int k = 0; k < kSharpness; ++k) likeness *= likeness;
    const double weight = likeness * std::exp(nearest_px / reach_px - distance);
    weights += weight;
    far += weight * distance;
    far_squared += weight * distance * distance;
    bends += weight * bend.per_m;
    far_bends += weight * distance * bend.per_m;
  }
  if (!(weights > kLeastWeight)) return std::nullopt;
  const double mean_per_m = bends / weights;
  const double spread = weights * far_squared - far * far;
  if (!(spread > kLeastSpread * weights * weights)) return mean_per_m;
  const double level_per_m = (far_squared * bends - far * far_bends) / spread;
  return std::clamp(level_per_m, std::min(mean_per_m, 0.0), std::max(mean_per_m, 0.0));
}

}  // namespace

Result<std::vector<std::uint8_t>> hidden_part(const Visibility& visibility,
                                              const std::vector<std::uint8_t>& measured,
                                              const IndexLists& neighbours) {
  const Eigen::Index count = neighbours.size();
  if (visibility.visible.rows() != count) {
    return Error{Errc::invalid_data, "the visibility has " +
                                         std::to_string(visibility.visible.rows()) +
                                         " vertices, the template " + std::to_string(count) +
                                         ": use one template throughout"};
  }
  std::vector<std::uint8_t> hidden(measured.size(), 0);
  std::vector<std::int32_t> front;
  const auto hide = [&](std::int32_t v) {
    if (has(measured, v) || has(hidden, v)) return;
    hidden[to_index(v)] = 1;
    front.push_back(v);
  };
  for (std::int32_t v = 0; v < count; ++v) {
    if (visibility.visible(v) == 0 && visibility.why(v) != SightReason::outside) hide(v);
  }
  if (front.empty()) return std::vector<std::uint8_t>{};
  while (!front.empty()) {
    const std::int32_t v = front.back();
    front.pop_back();
    for (const std::int32_t next : neighbours[v]) hide(next);
  }
  return hidden;
}

void add_unmeasured(const std::vector<std::uint8_t>& measured, std::vector<std::uint8_t>& hidden) {
  hidden.resize(measured.size(), 0);
  for (std::size_t v = 0; v < hidden.size(); ++v) {
    if (measured[v] == 0) hidden[v] = 1;
  }
}

void add_uncovered(const std::vector<std::uint8_t>& measured, const IndexLists& neighbours,
                   const std::vector<std::int32_t>& border, std::vector<std::uint8_t>& hidden) {
  const auto touches_measured = [&](std::int32_t v) {
    const auto around = neighbours[v];
    return std::any_of(around.begin(), around.end(),
                       [&](std::int32_t next) { return has(measured, next); });
  };
  std::vector<std::uint8_t> visited = measured;
  std::vector<std::int32_t> part;
  for (const std::int32_t start : border) {
    part.clear();
    const auto reach = [&](std::int32_t v) {
      if (has(visited, v)) return;
      visited[to_index(v)] = 1;
      part.push_back(v);
    };
    reach(start);
    for (std::size_t k = 0; k < part.size(); ++k) {
      for (const std::int32_t next : neighbours[part[k]]) reach(next);
    }
    if (std::all_of(part.begin(), part.end(), touches_measured)) continue;
    hidden.resize(measured.size(), 0);
    for (const std::int32_t v : part) hidden[to_index(v)] = 1;
  }
}

Result<void> BendContinuation::build(const Template& templ) {
  const Points3 rest_m = templ.vertices_m.matrix<3>();
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const Faces faces = templ.faces.matrix<3>();
  const auto topology = build_topology(faces, rest_m.rows());
  if (!topology) return topology.error();
  hinges_.clear();
  double length_px = 0.0;
  for (const BendingHinge& each : bending_hinges(rest_m, faces, *topology)) {
    Hinge hinge;
    hinge.vertex = each.vertex;
    auto& [a, b, c, d] = hinge.vertex;
    if (!is_left(flat_px, a, b, c)) std::swap(c, d);
    const Eigen::Vector3d origin = rest_m.row(a), edge = rest_m.row(b).transpose() - origin;
    for (std::size_t side = 0; side < 2; ++side) {
      const Eigen::Vector3d to = rest_m.row(hinge.vertex[2 + side]).transpose() - origin;
      hinge.along_m[side] = to.dot(edge.normalized());
      hinge.height_m[side] = (to - hinge.along_m[side] * edge.normalized()).norm();
    }
    const Eigen::Vector2d flat_a = flat_px.row(a), flat_b = flat_px.row(b);
    const Eigen::Vector2d flat_edge = flat_b - flat_a;
    hinge.place_px = 0.5 * (flat_a + flat_b);
    hinge.across = Eigen::Vector2d(flat_edge.y(), -flat_edge.x()).normalized();
    length_px += flat_edge.norm();
    hinge.edge_m = edge.norm();
    hinge.rest_rad = angle_rad(hinge, rest_m);
    hinges_.push_back(hinge);
  }
  const double edge_px = length_px / static_cast<double>(std::max<std::size_t>(1, hinges_.size()));
  const double diagonal_px = (flat_px.colwise().maxCoeff() - flat_px.colwise().minCoeff()).norm();
  reach_px_ = std::max(kReachInEdges * edge_px, kReachInDiagonals * diagonal_px);
  return {};
}

std::vector<std::uint8_t> BendContinuation::with_rim(
    const std::vector<std::uint8_t>& hidden) const {
  std::vector<std::uint8_t> grown = hidden;
  for (const Hinge& hinge : hinges_) {
    if (!touches(hinge, hidden)) continue;
    for (const std::int32_t v : hinge.vertex) grown[to_index(v)] = 1;
  }
  return grown;
}

bool BendContinuation::touches(const Hinge& hinge, const std::vector<std::uint8_t>& marked) {
  return std::any_of(hinge.vertex.begin(), hinge.vertex.end(),
                     [&](std::int32_t v) { return has(marked, v); });
}

/// The angle by which the face of d is turned towards the front, out of the plane of the face of c.
double BendContinuation::angle_rad(const Hinge& hinge, const Points3View& shape_m) {
  const auto [a, b, c, d] = hinge.vertex;
  const EdgeFrame frame = frame_of(shape_m.row(a), shape_m.row(b), shape_m.row(c));
  const Eigen::Vector3d to_d = (shape_m.row(d) - shape_m.row(a)).transpose();
  return std::atan2(to_d.dot(frame.front), to_d.dot(frame.away));
}

std::vector<double> BendContinuation::continued_angles(const Points3View& shape_m,
                                                       const std::vector<std::uint8_t>& hidden,
                                                       std::size_t most_seen) const {
  // Hidden parts pull at the edges next to them.
  const std::vector<std::uint8_t> unsure = with_rim(hidden);
  std::vector<SeenBend> seen, away_from_rim;
  std::vector<double> angles_rad;
  for (const Hinge& hinge : hinges_) {
    angles_rad.push_back(angle_rad(hinge, shape_m));
    if (touches(hinge, hidden) || !std::isfinite(angles_rad.back())) continue;
    const double bend_rad = angles_rad.back() - hinge.rest_rad;
    seen.push_back({hinge.place_px, hinge.across, bend_rad / hinge.width_m()});
    if (!touches(hinge, unsure)) away_from_rim.push_back(seen.back());
  }
  if (seen.empty()) return {};
  keep_evenly(seen, most_seen);
  keep_evenly(away_from_rim, most_seen);
  for (std::size_t h = 0; h < hinges_.size(); ++h) {
    const Hinge& hinge = hinges_[h];
    if (!touches(hinge, hidden)) continue;
    auto bend_per_m = expected_bend(away_from_rim, hinge.place_px, hinge.across, reach_px_);
    if (!bend_per_m) bend_per_m = expected_bend(seen, hinge.place_px, hinge.across, reach_px_);
    angles_rad[h] = hinge.rest_rad + hinge.width_m() * bend_per_m.value_or(0.0);
  }
  return angles_rad;
}

void BendContinuation::lay_out(const std::vector<double>& angles_rad,
                               std::vector<std::uint8_t> placed, Points3& shape_m) const {
  struct Sum {
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
    int count = 0;
  };
  while (true) {
    std::map<std::int32_t, Sum> next;
    for (std::size_t h = 0; h < hinges_.size(); ++h) {
      const Hinge& hinge = hinges_[h];
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        const std::size_t other = 1 - side;
        // Seen from d the edge runs the other way, so that both sides are the same case.
        const std::int32_t a = hinge.vertex[side == 1 ? 0 : 1];
        const std::int32_t b = hinge.vertex[side == 1 ? 1 : 0];
        const std::int32_t c = hinge.vertex[2 + other], d = hinge.vertex[2 + side];
        if (has(placed, d) || !has(placed, a) || !has(placed, b) || !has(placed, c)) continue;
        const EdgeFrame frame = frame_of(shape_m.row(a), shape_m.row(b), shape_m.row(c));
        const Eigen::Vector3d from_a = shape_m.row(hinge.vertex[0]);
        const Eigen::Vector3d forward = side == 1 ? frame.along : -frame.along;
        Sum& sum = next[d];
        sum.place_m += from_a + hinge.along_m[side] * forward +
                       hinge.height_m[side] * (std::cos(angles_rad[h]) * frame.away +
                                               std::sin(angles_rad[h]) * frame.front);
        ++sum.count;
      }
    }
    if (next.empty()) return;
    for (const auto& [vertex, sum] : next) {
      shape_m.row(vertex) = (sum.place_m / sum.count).transpose();
      placed[to_index(vertex)] = 1;
    }
  }
}

std::vector<std::uint8_t> BendContinuation::parts_kept_whole(
    const std::vector<std::uint8_t>& hidden, const Points3& shape_m) const {
  std::vector<std::int32_t> part(hidden.size());
  std::iota(part.begin(), part.end(), 0);
  const auto root = [&](std::int32_t v) {
    while (part[to_index(v)] != v) {
      std::int32_t& next = part[to_index(v)];
      v = next = part[to_index(next)];
    }
    return v;
  };
  std::vector<int> edges(hidden.size(), 0), torn(hidden.size(), 0);
  const auto each_hidden_edge = [&](const auto& visit) {
    for (const Hinge& hinge : hinges_) {
      worked_in_loop(&hinge - hinges_.data());
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        const std::int32_t apex = hinge.vertex[2 + side];
        const double along_m = hinge.along_m[side], height_m = hinge.height_m[side];
        visit(hinge.vertex[0], apex, std::hypot(along_m, height_m));
        visit(hinge.vertex[1], apex, std::hypot(hinge.edge_m - along_m, height_m));
      }
    }
  };
  each_hidden_edge([&](std::int32_t i, std::int32_t j, double /*length_m*/) {
    if (has(hidden, i) && has(hidden, j)) part[to_index(root(i))] = root(j);
  });
  each_hidden_edge([&](std::int32_t i, std::int32_t j, double length_m) {
    if (!has(hidden, i) && !has(hidden, j)) return;
    const auto of_part = to_index(root(has(hidden, i) ? i : j));
    const double strain = std::abs((shape_m.row(i) - shape_m.row(j)).norm() / length_m - 1.0);
    ++edges[of_part];
    if (!(strain < kTearingStrain)) ++torn[of_part];
  });
  std::vector<std::uint8_t> kept = hidden;
  for (std::size_t v = 0; v < hidden.size(); ++v) {
    const auto of_part = to_index(root(static_cast<std::int32_t>(v)));
    if (torn[of_part] > kTornShare * edges[of_part]) kept[v] = 0;
  }
  return kept;
}

HiddenBend BendContinuation::continued(const Points3View& shape_m,
                                       const std::vector<std::uint8_t>& hidden,
                                       const std::vector<DistanceConstraint>& bending) const {
  HiddenBend result{shape_m, bending};
  const std::vector<double> angles_rad = continued_angles(shape_m, hidden);
  if (angles_rad.empty()) return result;
  std::vector<std::uint8_t> placed;
  for (const std::uint8_t one : hidden) placed.push_back(one == 0 ? 1 : 0);
  lay_out(angles_rad, std::move(placed), result.shape_m);
  const std::vector<std::uint8_t> kept = parts_kept_whole(hidden, result.shape_m);
  for (std::size_t v = 0; v < hidden.size(); ++v) {
    if (kept[v] == hidden[v]) continue;
    const auto row = static_cast<Eigen::Index>(v);
    result.shape_m.row(row) = shape_m.row(row);
    ++result.torn_vertices;
  }
  std::map<std::pair<std::int32_t, std::int32_t>, double> lengths_m;
  for (std::size_t h = 0; h < hinges_.size(); ++h) {
    const Hinge& hinge = hinges_[h];
    if (!touches(hinge, kept)) continue;
    const double along_m = hinge.along_m[1] - hinge.along_m[0];
    const double flat_m = hinge.height_m[0] + hinge.height_m[1] * std::cos(angles_rad[h]);
    const double up_m = hinge.height_m[1] * std::sin(angles_rad[h]);
    lengths_m[std::minmax(hinge.vertex[2], hinge.vertex[3])] =
        std::sqrt(along_m * along_m + flat_m * flat_m + up_m * up_m);
  }
  for (DistanceConstraint& pair : result.bending) {
    const auto found = lengths_m.find(std::minmax(pair.i, pair.j));
    if (found != lengths_m.end() && found->second > 0.0) pair.rest_length_m = found->second;
  }
  return result;
}

}  // namespace weft::solvers
