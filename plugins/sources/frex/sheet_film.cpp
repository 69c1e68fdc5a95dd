// SPDX-License-Identifier: Apache-2.0
#include "sheet_film.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/rigid_alignment.hpp>

namespace weft::frex {
namespace {

constexpr double kHardly = 0.0015;  // strain up to which a stiff surface is bent

/// Sum over the inner vertices of the angle, in rad, by which the faces there do not fill a plane.
double curvature_rad(const MeshTopology& topology, const RestSheet& sheet) {
  Eigen::VectorXd missing_rad = Eigen::VectorXd::Constant(sheet.rest_m.rows(), 2.0 * M_PI);
  for (Eigen::Index f = 0; f < sheet.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = sheet.faces(f, k);
      const Eigen::RowVector3d corner = sheet.rest_m.row(v);
      const Eigen::RowVector3d a = sheet.rest_m.row(sheet.faces(f, (k + 1) % 3)) - corner;
      const Eigen::RowVector3d b = sheet.rest_m.row(sheet.faces(f, (k + 2) % 3)) - corner;
      missing_rad[v] -= std::atan2(a.cross(b).norm(), a.dot(b));
    }
  }
  for (const std::int32_t edge : topology.boundary_edges) {
    for (int end = 0; end < 2; ++end) missing_rad[topology.edges(edge, end)] = 0.0;
  }
  return missing_rad.cwiseAbs().sum();
}

/// True if the surface is a disc that is nearly developable, so that its lengths let it be bent.
bool bends_freely(const MeshTopology& topology, const RestSheet& sheet) {
  constexpr double kNearly_rad = 0.5;
  const Eigen::Index euler = sheet.rest_m.rows() - topology.edges.rows() + sheet.faces.rows();
  return euler == 1 && !topology.boundary_edges.empty() &&
         curvature_rad(topology, sheet) < kNearly_rad;
}

double largest_strain(const std::vector<DistanceConstraint>& edges, const Points3& places_m) {
  return strain_statistics(edges, places_m).max;
}

}  // namespace

Result<std::unique_ptr<Film>> SheetFilm::create(const MotionSettings& settings,
                                                const RestSheet& sheet, double fps) {
  if (sheet.first.empty()) return create_welded(settings, sheet, fps, std::nullopt);
  Welding welding(sheet.first, sheet.faces);
  const RestSheet welded = sheet.welded(welding);
  return create_welded(settings, welded, fps, std::move(welding));
}

Result<std::unique_ptr<Film>> SheetFilm::create_welded(const MotionSettings& settings,
                                                       const RestSheet& sheet, double fps,
                                                       std::optional<Welding> welding) {
  const auto topology = build_topology(sheet.faces, sheet.rest_m.rows());
  if (!topology) return topology.error();
  Choreography choreography(settings, sheet);
  const Points3 start_m = choreography.start();
  auto edges = distance_constraints(topology->edges, start_m);
  if (!edges) return edges.error();
  auto cloth = sheet.cloth(start_m);
  if (!cloth) return cloth.error();
  const bool is_stiff = welding && !bends_freely(*topology, sheet);
  return std::unique_ptr<Film>(new SheetFilm(std::move(choreography), *std::move(cloth),
                                             *std::move(edges), fps, std::move(welding), is_stiff));
}

SheetFilm::SheetFilm(Choreography choreography, scene::Cloth cloth,
                     std::vector<DistanceConstraint> rest_edges, double fps,
                     std::optional<Welding> welding, bool is_stiff)
    : choreography_(std::move(choreography)),
      cloth_(std::move(cloth)),
      rest_edges_(std::move(rest_edges)),
      fps_(fps),
      welding_(std::move(welding)),
      is_stiff_(is_stiff) {
  states_.push_back(state_of(cloth_.vertices_m(), cloth_.worst_strain()));
}

Result<const FilmState*> SheetFilm::at(std::int64_t index, const Call& call) {
  while (static_cast<std::int64_t>(states_.size()) <= index) {
    if (call.cancelled()) return Error{Errc::cancelled, "the simulation was cancelled"};
    const double t_s = static_cast<double>(states_.size()) / fps_;
    auto state = is_stiff_ ? hardly_bent(t_s) : simulated(t_s);
    if (!state) {
      return Error{state.error().code,
                   "frame " + std::to_string(states_.size()) + ": " + state.error().message};
    }
    states_.push_back(*std::move(state));
  }
  return &states_[to_index(index)];
}

Result<FilmState> SheetFilm::simulated(double t_s) {
  cloth_.set_lengths_of(choreography_.lengths_at(t_s));
  if (auto moved = cloth_.step(1.0 / fps_, choreography_.guides_at(t_s)); !moved) {
    return moved.error();
  }
  return state_of(cloth_.vertices_m(), cloth_.worst_strain());
}

/// Between the unbent surface and the one that the pattern describes, as far as lengths allow.
Result<FilmState> SheetFilm::hardly_bent(double t_s) const {
  constexpr int kHalvings = 20;
  const Points3 unbent_m = choreography_.lengths_at(t_s);
  Points3 target_m(unbent_m.rows(), 3);
  for (const scene::ClothGuide& guide : choreography_.guides_at(t_s)) {
    target_m.row(guide.vertex) = guide.target_m.transpose();
  }
  const auto pose = align_points(unbent_m, target_m);
  if (!pose) return pose.error();
  const Points3 rigid_m = transform_points(*pose, unbent_m);
  std::vector<DistanceConstraint> edges = rest_edges_;
  for (DistanceConstraint& edge : edges) {
    edge.rest_length_m = (unbent_m.row(edge.i) - unbent_m.row(edge.j)).norm();
  }
  const auto bent = [&](double share) -> Points3 { return rigid_m + share * (target_m - rigid_m); };
  double low = 0.0, high = 1.0;
  if (largest_strain(edges, target_m) <= kHardly) low = high;
  for (int k = 0; k < kHalvings && low < high; ++k) {
    const double middle = 0.5 * (low + high);
    (largest_strain(edges, bent(middle)) <= kHardly ? low : high) = middle;
  }
  const Points3 places_m = bent(low);
  return state_of(places_m, largest_strain(edges, places_m));
}

FilmState SheetFilm::state_of(const Points3& places_m, double residual_strain) const {
  return {welding_ ? welding_->spread(places_m) : places_m, residual_strain,
          strain_statistics(rest_edges_, places_m)};
}

}  // namespace weft::frex
