// SPDX-License-Identifier: Apache-2.0
#include "sheet_film.hpp"

#include <utility>
#include <weft/core/index.hpp>
#include <weft/geometry/mesh_topology.hpp>

namespace weft::frex {

Result<SheetFilm> SheetFilm::create(const MotionSettings& settings, const RestSheet& sheet,
                                    double fps) {
  const auto topology = build_topology(sheet.faces, sheet.rest_m.rows());
  if (!topology) return topology.error();
  Choreography choreography(settings, sheet);
  const Points3 start_m = choreography.start();
  auto edges = distance_constraints(topology->edges, start_m);
  if (!edges) return edges.error();
  auto cloth = sheet.cloth(start_m);
  if (!cloth) return cloth.error();
  return SheetFilm(std::move(choreography), *std::move(cloth), *std::move(edges), fps);
}

SheetFilm::SheetFilm(Choreography choreography, scene::Cloth cloth,
                     std::vector<DistanceConstraint> rest_edges, double fps)
    : choreography_(std::move(choreography)),
      cloth_(std::move(cloth)),
      rest_edges_(std::move(rest_edges)),
      fps_(fps) {
  states_.push_back(state_now());
}

Result<const SheetState*> SheetFilm::at(std::int64_t index, const Call& call) {
  while (static_cast<std::int64_t>(states_.size()) <= index) {
    if (call.cancelled()) return Error{Errc::cancelled, "the simulation was cancelled"};
    const double t_s = static_cast<double>(states_.size()) / fps_;
    cloth_.set_lengths_of(choreography_.lengths_at(t_s));
    if (auto moved = cloth_.step(1.0 / fps_, choreography_.guides_at(t_s)); !moved) {
      return Error{moved.error().code,
                   "frame " + std::to_string(states_.size()) + ": " + moved.error().message};
    }
    states_.push_back(state_now());
  }
  return &states_[to_index(index)];
}

SheetState SheetFilm::state_now() const {
  return {cloth_.vertices_m(), cloth_.worst_strain(),
          strain_statistics(rest_edges_, cloth_.vertices_m())};
}

}  // namespace weft::frex
