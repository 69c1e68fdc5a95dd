// SPDX-License-Identifier: Apache-2.0
#include "solid/solid_film.hpp"

#include <cmath>
#include <utility>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/mesh_topology.hpp>

#include "common/scene/random_stream.hpp"

namespace weft::frex {
namespace {

constexpr std::uint64_t kSolidStream = 7;

}  // namespace

Result<std::unique_ptr<Film>> SolidFilm::create(const SpaceMap::Settings& settings,
                                                const SwaySettings& sways, const SolidRest& rest,
                                                const Eigen::Matrix3d& view, double fps) {
  const auto map = SpaceMap::create(settings, rest.size_m);
  if (!map) return map.error();
  const auto topology = build_topology(rest.surface.truth_faces, rest.surface.truth_points);
  if (!topology) return topology.error();
  auto edges = distance_constraints(topology->edges, rest.surface.places_m);
  if (!edges) return edges.error();
  return std::unique_ptr<Film>(new SolidFilm(*map, sways, rest, *std::move(edges), view, fps,
                                             scene::random_stream(sways.seed, kSolidStream)));
}

SolidFilm::SolidFilm(const SpaceMap& map, const SwaySettings& sways, const SolidRest& rest,
                     std::vector<DistanceConstraint> rest_edges, const Eigen::Matrix3d& view,
                     double fps, Rng rng)
    : map_(map),
      sways_(sways, rng),
      sign_(rng.below(2) == 0 ? -1.0 : 1.0),
      rest_m_(rest.surface.places_m),
      rest_edges_(std::move(rest_edges)),
      view_(view),
      fps_(fps) {}

double SolidFilm::amount_at(double t_s) const {
  return 0.5 * sign_ * (1.0 - std::cos(sways_.phase_at(t_s)));
}

Result<const FilmState*> SolidFilm::at(std::int64_t index, const Call& /*call*/) {
  const double t_s = static_cast<double>(index) / fps_;
  const double amount = amount_at(t_s);
  Eigen::Isometry3d pose = sways_.pose_at(t_s);
  pose.linear() *= view_;
  state_.vertices_m.resize(rest_m_.rows(), 3);
  for (Eigen::Index v = 0; v < rest_m_.rows(); ++v) {
    worked_in_loop(v, 10);
    state_.vertices_m.row(v) = (pose * map_(rest_m_.row(v).transpose(), amount)).transpose();
  }
  state_.true_strain = strain_statistics(rest_edges_, state_.vertices_m);
  return &state_;
}

}  // namespace weft::frex
