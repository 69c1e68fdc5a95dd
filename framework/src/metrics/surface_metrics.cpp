// SPDX-License-Identifier: Apache-2.0
#include "metrics/surface_metrics.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

namespace weft::evaluation {
namespace {

namespace index = boost::geometry::index;

using Corners = std::array<Eigen::Vector3d, 3>;

/// Each face of the mesh is cut into so many triangles of equal area along each side.
constexpr int kCuts = 4;
constexpr double kDense = 0.01;  // of the diagonal of the mesh

/// Ericson, Real-Time Collision Detection, 2005, 5.1.5: by the region of the plane in which the
/// point lies.
double distance_to(const Corners& corners, const Eigen::Vector3d& point) {
  const auto& [a, b, c] = corners;
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const auto to_segment = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
    const double length2 = way.squaredNorm();
    const double at = length2 > 0.0 ? std::clamp((point - from).dot(way) / length2, 0.0, 1.0) : 0.0;
    return (from + at * way - point).norm();
  };
  const Eigen::Vector3d normal = ab.cross(ac);
  const double area2 = normal.squaredNorm();
  if (area2 > 0.0) {
    const Eigen::Vector3d ap = point - a;
    const double v = ap.cross(ac).dot(normal) / area2, w = ab.cross(ap).dot(normal) / area2;
    if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) return std::abs(ap.dot(normal)) / std::sqrt(area2);
  }
  return std::min({to_segment(a, ab), to_segment(a, ac), to_segment(b, c - b)});
}

/// Triangles, or points, to look for the nearest one.
class Nearest {
 public:
  void add(const Corners& corners) { triangles_.push_back(corners); }

  /// After the last one.
  void sort() {
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const auto& [a, b, c] = triangles_[i];
      entries.emplace_back(box(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)), i);
    }
    tree_ = Tree(entries);
  }

  double distance(const Eigen::Vector3d& point) const {
    found_.clear();
    tree_.query(index::nearest(Place(point.x(), point.y(), point.z()), 4),
                std::back_inserter(found_));
    double least = least_of_found(point);
    // Another may be nearer although its box is farther off than theirs.
    found_.clear();
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(least);
    tree_.query(index::intersects(box(point - reach, point + reach)), std::back_inserter(found_));
    return std::min(least, least_of_found(point));
  }

 private:
  using Place = boost::geometry::model::point<double, 3, boost::geometry::cs::cartesian>;
  using Box = boost::geometry::model::box<Place>;
  using Entry = std::pair<Box, std::size_t>;
  using Tree = index::rtree<Entry, index::quadratic<16>>;

  static Box box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    return {Place(low.x(), low.y(), low.z()), Place(high.x(), high.y(), high.z())};
  }
  double least_of_found(const Eigen::Vector3d& point) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Entry& entry : found_) {
      least = std::min(least, distance_to(triangles_[entry.second], point));
    }
    return least;
  }

  std::vector<Corners> triangles_;
  Tree tree_;
  mutable std::vector<Entry> found_;
};

Nearest surface_of(const Points3View& points, const FacesView& faces) {
  Nearest nearest;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    nearest.add({points.row(faces(f, 0)), points.row(faces(f, 1)), points.row(faces(f, 2))});
  }
  nearest.sort();
  return nearest;
}

Nearest cloud_of(const Points3View& points) {
  Nearest nearest;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    nearest.add({points.row(i), points.row(i), points.row(i)});
  }
  nearest.sort();
  return nearest;
}

double area_of(const Points3View& vertices_m, const FacesView& faces) {
  double area_m2 = 0.0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::RowVector3d a = vertices_m.row(faces(f, 0));
    area_m2 +=
        0.5 * (vertices_m.row(faces(f, 1)) - a).cross(vertices_m.row(faces(f, 2)) - a).norm();
  }
  return area_m2;
}

/// Sums of distances and of their squares, in mm.
struct Sums {
  double weight = 0.0, distance = 0.0, square = 0.0;

  void add(double share, double distance_m) {
    const double mm = kMmPerM * distance_m;
    weight += share;
    distance += share * mm;
    square += share * mm * mm;
  }
};

/// Calls visit(place) for the middle of each of the triangles into which a face is cut.
template <class Visit>
void for_each_place(const Corners& corners, Visit&& visit) {
  const auto at = [&](double along_ab, double along_ac) {
    return Eigen::Vector3d(corners[0] + along_ab / kCuts * (corners[1] - corners[0]) +
                           along_ac / kCuts * (corners[2] - corners[0]));
  };
  constexpr double kThird = 1.0 / 3.0;
  for (int i = 0; i < kCuts; ++i) {
    for (int j = 0; i + j < kCuts; ++j) {
      visit(at(i + kThird, j + kThird));
      if (i + j + 1 < kCuts) visit(at(i + 2.0 * kThird, j + 2.0 * kThird));
    }
  }
}

}  // namespace

SurfaceMetrics surface_metrics(const Points3View& vertices_m, const FacesView& faces,
                               const GroundTruth& truth) {
  const auto points_m = truth.points_m.matrix<3>();
  SurfaceMetrics metrics;
  Sums from, to;
  const Nearest mesh = surface_of(vertices_m, faces);
  for (Eigen::Index i = 0; i < points_m.rows(); ++i) from.add(1.0, mesh.distance(points_m.row(i)));
  metrics.from_truth_mm = from.distance / from.weight;
  metrics.from_truth_squared_mm2 = from.square / from.weight;
  const double diagonal_m =
      (vertices_m.colwise().maxCoeff() - vertices_m.colwise().minCoeff()).norm();
  const double spacing_m =
      std::sqrt(area_of(vertices_m, faces) / static_cast<double>(points_m.rows()));
  if (!truth.faces.present() && spacing_m > kDense * diagonal_m) return metrics;
  const Nearest truly =
      truth.faces.present() ? surface_of(points_m, truth.faces.matrix<3>()) : cloud_of(points_m);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Corners corners{vertices_m.row(faces(f, 0)), vertices_m.row(faces(f, 1)),
                          vertices_m.row(faces(f, 2))};
    const double area_m2 = (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
    for_each_place(corners,
                   [&](const Eigen::Vector3d& place) { to.add(area_m2, truly.distance(place)); });
  }
  metrics.to_truth_mm = to.distance / to.weight;
  metrics.to_truth_squared_mm2 = to.square / to.weight;
  return metrics;
}

SurfaceSummary summarise_surfaces(std::span<const SurfaceMetrics> frames) {
  const auto known = [&](auto&& value_of) {
    std::vector<double> values;
    for (const SurfaceMetrics& frame : frames) {
      if (const double value = value_of(frame); std::isfinite(value)) values.push_back(value);
    }
    return values;
  };
  const auto mean_of = [&](auto&& value_of) { return mean_or_unknown(known(value_of)); };
  SurfaceSummary summary;
  summary.frames = static_cast<std::int64_t>(frames.size());
  summary.from_truth_mm = mean_of([](const auto& frame) { return frame.from_truth_mm; });
  summary.to_truth_mm = mean_of([](const auto& frame) { return frame.to_truth_mm; });
  summary.from_truth_squared_mm2 =
      mean_of([](const auto& frame) { return frame.from_truth_squared_mm2; });
  summary.to_truth_squared_mm2 =
      mean_of([](const auto& frame) { return frame.to_truth_squared_mm2; });
  summary.chamfer_mm = mean_of([](const auto& frame) { return frame.chamfer_mm(); });
  const std::vector<double> sums_mm2 =
      known([](const auto& frame) { return frame.chamfer_squared_mm2(); });
  summary.frames_both_ways = static_cast<std::int64_t>(sums_mm2.size());
  summary.chamfer_squared_mm2 = mean_or_unknown(sums_mm2);
  summary.worst_chamfer_squared_mm2 = percentile(sums_mm2, 100.0);
  return summary;
}

}  // namespace weft::evaluation
