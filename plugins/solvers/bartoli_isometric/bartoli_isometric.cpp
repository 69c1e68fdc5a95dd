// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/texture_metric.hpp>
#include <weft/sdk/solver.hpp>

#include "isometric_point.hpp"
#include "smooth_surface.hpp"

namespace weft::bartoli_isometric {
namespace {

constexpr std::size_t kFewestPoints = 16;
constexpr std::int64_t kFewestMatches = 4;  // three fit an affine map, which shows no perspective

/// The closed-form isometric solution: depth from a warp and its first derivatives.
class BartoliIsometric final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "Bartoli, Gerard, Chadebecq, Collins, Pizarro, Shape-from-Template, "
          "TPAMI 37(10) (2015)",
      .needs = "correspondences",
      .reads = ""};

  explicit BartoliIsometric(Params& p) {
    p.read("grid", grid_, "", {4, 200}, "the warp is read at so many places along u and along v");
    p.read("reach", reach_, "", {0.001, 10.0},
           "places further than this part of the template's diagonal from any match are not used");
    p.read("control", control_, "", {4, 40}, "control points of the surface along u and along v");
    p.read("smoothing", smoothing_, "", {1e-6, 1e6},
           "of the surface: bending energy in areas of a knot cell");
    p.component("warp", warp_, "the warp that is fitted to the kept matches");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (!in.correspondences) return Error{Errc::invalid_data, "needs 'correspondences'"};
    const Correspondences& matches = *in.correspondences;
    const auto kept = std::count_if(matches.kept.data(), matches.kept.data() + matches.count(),
                                    [](std::uint8_t one) { return one != 0; });
    if (kept < kFewestMatches) {
      return no_result("too few matches: " + std::to_string(kept) + " kept of at least " +
                       std::to_string(kFewestMatches));
    }
    if (auto ready = prepare_places(in.templ); !ready) return ready.error();
    const auto warp = warp_.fit(in.call, *in.correspondences, in.templ);
    if (!warp) return warp.error();
    const auto samples = evaluate(in.call, *warp, {make_array<double>(places_px_), 1});
    if (!samples) return samples.error();
    if (!samples->jacobian.present()) {
      return Error{Errc::invalid_data, "the warp gives no derivatives: use warps/bbs"};
    }
    mark_near(*in.correspondences);
    const Points2 used_px = reconstruct(in.camera, *samples);
    if (points_m_.size() < kFewestPoints) {
      return no_result("the depth is known at " + std::to_string(points_m_.size()) +
                       " places of at least " + std::to_string(kFewestPoints));
    }
    Points3 points_m(used_px.rows(), 3);
    for (Eigen::Index p = 0; p < points_m.rows(); ++p) {
      points_m.row(p) = points_m_[to_index(p)].transpose();
    }
    if (auto fitted = surface_.fit(used_px, points_m, smoothing_); !fitted) return fitted.error();
    return build_shape(in, warp.degenerate_reason());
  }

 private:
  /// The grid in the texture where it lies on the mesh, and the metric there.
  Result<void> prepare_places(const Template& templ) {
    if (templ.revision != 0 && templ.revision == revision_) return {};
    revision_ = 0;  // until all is made
    const auto vertices_m = templ.vertices_m.matrix<3>();
    const auto flat_px = templ.flat_px.matrix<2>();
    const auto faces = templ.faces.matrix<3>();
    const auto topology = build_topology(faces, vertices_m.rows());
    if (!topology) return topology.error();
    auto constraints = distance_constraints(topology->edges, vertices_m);
    if (!constraints) return constraints.error();
    const auto locator = FaceLocator::create(flat_px, faces, 0.0);
    if (!locator) return locator.error();
    low_px_ = flat_px.colwise().minCoeff();
    const Eigen::RowVector2d size = flat_px.colwise().maxCoeff() - low_px_;
    if (!(size.minCoeff() > 0.0)) {
      return Error{Errc::invalid_data, "the template has no area in the texture"};
    }
    const SplineDomain domain{low_px_.x(), low_px_.x() + size.x(),
                              low_px_.y(), low_px_.y() + size.y(),
                              control_,    control_};
    surface_.set_domain(domain);
    cell_px_ = reach_ * size.norm();
    columns_ = cell_along(size.x()) + 1;
    rows_ = cell_along(size.y()) + 1;
    std::vector<Eigen::RowVector2d> places;
    metrics_.clear();
    for (int i = 0; i < grid_; ++i) {
      for (int j = 0; j < grid_; ++j) {
        const Eigen::RowVector2d place = low_px_ + Eigen::RowVector2d((i + 0.5) / grid_ * size.x(),
                                                                      (j + 0.5) / grid_ * size.y());
        const FaceLocation at = locator->locate(place.transpose());
        if (!at.inside) continue;
        const auto rest = texture_jacobian(vertices_m, flat_px, faces, at.face);
        places.push_back(place);
        metrics_.push_back(rest.transpose() * rest);
      }
    }
    places_px_.resize(static_cast<Eigen::Index>(places.size()), 2);
    for (std::size_t k = 0; k < places.size(); ++k) {
      places_px_.row(static_cast<Eigen::Index>(k)) = places[k];
    }
    constraints_ = *std::move(constraints);
    revision_ = templ.revision;
    return {};
  }

  std::int64_t cell_along(double px) const {
    return static_cast<std::int64_t>(std::floor(px / cell_px_));
  }

  /// Whether a place is in a cell that holds a kept match, or beside one.
  bool near_match(const Eigen::RowVector2d& place_px) const {
    const Eigen::RowVector2d offset = place_px - low_px_;
    const std::int64_t i = cell_along(offset.x()), j = cell_along(offset.y());
    return i >= 0 && j >= 0 && i < columns_ && j < rows_ && near_[to_index(i * rows_ + j)] != 0;
  }

  void mark_near(const Correspondences& matches) {
    near_.assign(to_index(columns_ * rows_), 0);
    for (std::int64_t k = 0; k < matches.count(); ++k) {
      const Eigen::RowVector2d offset = matches.template_px.matrix<2>().row(k) - low_px_;
      const bool on_mesh = offset.cwiseAbs().maxCoeff() < 1e9;  // false for NaN
      if (matches.kept(k) == 0 || !on_mesh) continue;
      const std::int64_t i = cell_along(offset.x()), j = cell_along(offset.y());
      for (std::int64_t a = std::max<std::int64_t>(0, i - 1); a <= std::min(columns_ - 1, i + 1);
           ++a) {
        for (std::int64_t b = std::max<std::int64_t>(0, j - 1); b <= std::min(rows_ - 1, j + 1);
             ++b) {
          near_[to_index(a * rows_ + b)] = 1;
        }
      }
    }
  }

  /// Points in space at the places that can be used; those places, [n,2] px.
  Points2 reconstruct(const Camera& camera, const WarpSamples& samples) {
    std::vector<Eigen::RowVector2d> used;
    points_m_.clear();
    folded_ = 0;
    const Eigen::Vector2d focal(camera.fx, camera.fy), centre(camera.cx, camera.cy);
    for (Eigen::Index p = 0; p < places_px_.rows(); ++p) {
      if (samples.valid(p) == 0 || !near_match(places_px_.row(p))) continue;
      const Eigen::Vector2d pixel = samples.xy_px.matrix<2>().row(p);
      const double* j = samples.jacobian.data() + 4 * p;
      Eigen::Matrix2d jacobian;
      jacobian << j[0] / focal.x(), j[1] / focal.x(), j[2] / focal.y(), j[3] / focal.y();
      const auto point =
          isometric_point((pixel - centre).cwiseQuotient(focal), jacobian, metrics_[to_index(p)]);
      folded_ += point ? 0 : 1;
      if (!point) continue;
      points_m_.emplace_back(point->distance_m * point->ray);
      used.emplace_back(places_px_.row(p));
    }
    Points2 used_px(static_cast<Eigen::Index>(used.size()), 2);
    for (std::size_t k = 0; k < used.size(); ++k) {
      used_px.row(static_cast<Eigen::Index>(k)) = used[k];
    }
    return used_px;
  }

  Result<Shape> build_shape(const SolverInput& in, const std::string& warp_is_degenerate) const {
    const auto flat_px = in.templ.flat_px.matrix<2>();
    const Points3 vertices_m = surface_.at(flat_px);
    if (!(vertices_m.allFinite() && vertices_m.col(2).minCoeff() > 0.0)) {
      return no_result("the surface reaches behind the camera");
    }
    Shape shape;
    shape.vertices_m = make_array<double>(vertices_m);
    shape.source = Array<std::uint8_t>({vertices_m.rows()});
    for (Eigen::Index v = 0; v < flat_px.rows(); ++v) {
      shape.source(v) = near_match(flat_px.row(v)) ? 1 : 0;
    }
    const double strain = mean(strains(constraints_, vertices_m));
    const ShapeEvidence evidence =
        shape_evidence(in.templ, in.camera, vertices_m, in.correspondences, in.sightlines);
    // Half where lengths are off by 3 % in the mean; not calibrated.
    shape.confidence = std::min(1.0, evidence.agreeing / 30.0) *
                       logistic(-2.0 * std::log((strain + 1e-3) / 0.03)) *
                       confidence_of_filters(in.correspondences);
    shape.diag.set("points", static_cast<double>(points_m_.size()));
    shape.diag.set("folded_points", static_cast<double>(folded_));
    shape.diag.set("strain", strain);
    if (!warp_is_degenerate.empty()) return degenerate(std::move(shape), warp_is_degenerate);
    return shape;
  }

  int grid_ = 32;
  double reach_ = 0.1;
  int control_ = 12;
  double smoothing_ = 0.1;
  WarpComponent warp_{"warps/bbs"};

  std::uint64_t revision_ = 0;  ///< of the template that all of this is for
  std::vector<DistanceConstraint> constraints_;
  SmoothSurface surface_;
  Points2 places_px_;                     ///< [n,2] px of the texture
  std::vector<Eigen::Matrix2d> metrics_;  ///< [n] m^2/px^2
  Eigen::RowVector2d low_px_;
  double cell_px_ = 1.0;
  std::int64_t columns_ = 1, rows_ = 1;
  std::vector<std::uint8_t> near_;         ///< [columns * rows]
  std::vector<Eigen::Vector3d> points_m_;  ///< of this frame
  int folded_ = 0;                         ///< of this frame
};

}  // namespace
}  // namespace weft::bartoli_isometric

using weft::bartoli_isometric::BartoliIsometric;
WEFT_PLUGIN(BartoliIsometric, "solvers/bartoli_isometric", "1.0.0",
            "Closed-form isometric shape from a warp and its first derivatives.")
