// SPDX-License-Identifier: Apache-2.0
#include "warp_grid.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/texture_metric.hpp>

#include "seen/image_line.hpp"

namespace weft::solvers {
namespace {

constexpr std::size_t kFewestMatches = 4;  // three fit an affine map, which shows no perspective

}  // namespace

IsometricReading isometric_reading(const std::vector<WarpPlace>& places) {
  IsometricReading reading;
  for (const WarpPlace& place : places) {
    const auto point = isometric_point(place.eta, place.jacobian, place.metric);
    reading.folded += point ? 0 : 1;
    if (!point) continue;
    reading.places.push_back(place);
    reading.points.push_back(*point);
  }
  const auto count = static_cast<Eigen::Index>(reading.points.size());
  reading.places_px.resize(count, 2);
  reading.points_m.resize(count, 3);
  for (Eigen::Index k = 0; k < count; ++k) {
    const IsometricPoint& point = reading.points[to_index(k)];
    reading.places_px.row(k) = reading.places[to_index(k)].place_px.transpose();
    reading.points_m.row(k) = point.distance_m * point.ray.transpose();
  }
  return reading;
}

void WarpGrid::declare(Params& p) {
  p.read("grid", grid_, "", {4, 200},
         "number of points along u and along v at which the warp is evaluated");
  p.read("reach", reach_, "", {0.001, 10.0},
         "maximum distance of an evaluation point from the nearest match, relative to the "
         "template's diagonal");
  p.component("warp", warp_, "warp that is fitted to the kept matches");
}

Result<WarpReading> WarpGrid::read(const SolverInput& in) {
  if (!in.correspondences) return Error{Errc::invalid_data, "needs 'correspondences'"};
  const Correspondences& matches = *in.correspondences;
  std::vector<std::int64_t> kept;
  for (std::int64_t k = 0; k < matches.count(); ++k) {
    if (matches.kept(k) != 0) kept.push_back(k);
  }
  if (kept.size() < kFewestMatches) {
    return no_result("too few matches: " + std::to_string(kept.size()) + " kept of at least " +
                     std::to_string(kFewestMatches));
  }
  const auto pixel = [&](std::int64_t k) -> Eigen::Vector2d {
    return matches.image_px.matrix<2>().row(k).transpose();
  };
  // The warp names one that is not finite.
  const bool are_finite =
      std::all_of(kept.begin(), kept.end(), [&](std::int64_t k) { return pixel(k).allFinite(); });
  if (are_finite && lie_on_a_line(kept, pixel)) {
    return no_result("the matches lie on a line of the image, or in one place");
  }
  if (auto ready = prepare(in.templ); !ready) return ready.error();
  const auto warp = warp_.fit(in.call, matches, in.templ);
  if (!warp) return warp.error();
  const auto samples = evaluate(in.call, *warp, {make_array<double>(places_px_), 1});
  if (!samples) return samples.error();
  if (!samples->jacobian.present()) {
    return Error{Errc::invalid_data, "the warp gives no derivatives: use warps/bbs"};
  }
  mark_near(matches);
  return WarpReading{places_near(in.camera, *samples), rest_.size(), warp.degenerate_reason()};
}

/// All that follows from the template alone.
Result<void> WarpGrid::prepare(const Template& templ) {
  if (templ.revision != 0 && templ.revision == revision_) return {};
  revision_ = 0;  // until all is made
  const auto vertices_m = templ.vertices_m.matrix<3>();
  const auto flat_px = templ.flat_px.matrix<2>();
  const auto topology = build_topology(templ.faces.matrix<3>(), vertices_m.rows());
  if (!topology) return topology.error();
  auto edges = distance_constraints(topology->edges, vertices_m);
  if (!edges) return edges.error();
  low_px_ = flat_px.colwise().minCoeff();
  size_px_ = flat_px.colwise().maxCoeff() - low_px_;
  if (!(size_px_.minCoeff() > 0.0)) {
    return Error{Errc::invalid_data, "the template has no area in the texture"};
  }
  cell_px_ = reach_ * size_px_.norm();
  columns_ = cell_along(size_px_.x()) + 1;
  rows_ = cell_along(size_px_.y()) + 1;
  if (auto placed = place_grid(templ); !placed) return placed;
  edges_ = *std::move(edges);
  revision_ = templ.revision;
  return {};
}

/// The grid where it lies on the mesh, and the metric there.
Result<void> WarpGrid::place_grid(const Template& templ) {
  const auto vertices_m = templ.vertices_m.matrix<3>();
  const auto flat_px = templ.flat_px.matrix<2>();
  const auto faces = templ.faces.matrix<3>();
  const auto locator = FaceLocator::create(flat_px, faces, 0.0);
  if (!locator) return locator.error();
  rest_.clear();
  for (int i = 0; i < grid_; ++i) {
    worked(10 * grid_);
    for (int j = 0; j < grid_; ++j) {
      const Eigen::RowVector2d place =
          low_px_ +
          Eigen::RowVector2d((i + 0.5) / grid_ * size_px_.x(), (j + 0.5) / grid_ * size_px_.y());
      const FaceLocation at = locator->locate(place.transpose());
      if (!at.inside) continue;
      const auto rest = texture_jacobian(vertices_m, flat_px, faces, at.face);
      rest_.push_back({i, j, place.transpose(), rest.transpose() * rest});
    }
  }
  places_px_.resize(static_cast<Eigen::Index>(rest_.size()), 2);
  for (std::size_t k = 0; k < rest_.size(); ++k) {
    places_px_.row(static_cast<Eigen::Index>(k)) = rest_[k].place_px.transpose();
  }
  return {};
}

SplineDomain WarpGrid::domain(int control) const {
  return {low_px_.x(), low_px_.x() + size_px_.x(), low_px_.y(), low_px_.y() + size_px_.y(), control,
          control};
}

std::int64_t WarpGrid::cell_along(double px) const {
  return static_cast<std::int64_t>(std::floor(px / cell_px_));
}

/// True if a place is in a cell that contains a kept match, or beside one.
bool WarpGrid::near_match(const Eigen::RowVector2d& place_px) const {
  const Eigen::RowVector2d offset = place_px - low_px_;
  const std::int64_t i = cell_along(offset.x()), j = cell_along(offset.y());
  return i >= 0 && j >= 0 && i < columns_ && j < rows_ && near_[to_index(i * rows_ + j)] != 0;
}

void WarpGrid::mark_near(const Correspondences& matches) {
  near_.assign(to_index(columns_ * rows_), 0);
  for (std::int64_t k = 0; k < matches.count(); ++k) {
    const Eigen::RowVector2d offset = matches.template_px.matrix<2>().row(k) - low_px_;
    const bool on_mesh = offset.cwiseAbs().maxCoeff() < 1e9;  // false for NaN
    if (matches.kept(k) == 0 || !on_mesh) continue;
    const std::int64_t i = cell_along(offset.x()), j = cell_along(offset.y());
    for (auto a = std::max<std::int64_t>(0, i - 1); a <= std::min(columns_ - 1, i + 1); ++a) {
      for (auto b = std::max<std::int64_t>(0, j - 1); b <= std::min(rows_ - 1, j + 1); ++b) {
        near_[to_index(a * rows_ + b)] = 1;
      }
    }
  }
}

std::vector<WarpPlace> WarpGrid::places_near(const Camera& camera,
                                             const WarpSamples& samples) const {
  std::vector<WarpPlace> places;
  const Eigen::Vector2d focal_px(camera.fx, camera.fy), centre_px(camera.cx, camera.cy);
  for (Eigen::Index p = 0; p < places_px_.rows(); ++p) {
    if (samples.valid(p) == 0 || !near_match(places_px_.row(p))) continue;
    WarpPlace place = rest_[to_index(p)];
    const Eigen::Vector2d pixel = samples.xy_px.matrix<2>().row(p);
    place.eta = (pixel - centre_px).cwiseQuotient(focal_px);
    const double* j = samples.jacobian.data() + 4 * p;
    place.jacobian << j[0] / focal_px.x(), j[1] / focal_px.x(), j[2] / focal_px.y(),
        j[3] / focal_px.y();
    places.push_back(place);
  }
  return places;
}

}  // namespace weft::solvers
