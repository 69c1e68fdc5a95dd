// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/sdk/call.hpp>

#include "choreography.hpp"
#include "film/film.hpp"
#include "film/welding.hpp"

namespace weft::frex {

/// The simulated surface, frame after frame. It simulates and keeps all frames before a requested
/// one, so that each frame is the same for any order of requests.
///
/// A surface with seams is simulated with one vertex for each place. If it is no disc or far from
/// developable, such as a can or a cushion, its lengths let it bend only a little. It is then not
/// simulated: it moves rigidly along with the pattern and is bent as far as no edge is strained by
/// more than 0.15 %.
class SheetFilm final : public Film {
 public:
  static Result<std::unique_ptr<Film>> create(const MotionSettings& settings,
                                              const RestSheet& sheet, double fps);

  Result<const FilmState*> at(std::int64_t index, const Call& call) override;

 private:
  SheetFilm(Choreography choreography, scene::Cloth cloth,
            std::vector<DistanceConstraint> rest_edges, double fps, std::optional<Welding> welding,
            bool is_stiff);
  static Result<std::unique_ptr<Film>> create_welded(const MotionSettings& settings,
                                                     const RestSheet& sheet, double fps,
                                                     std::optional<Welding> welding);
  Result<FilmState> simulated(double t_s);
  Result<FilmState> hardly_bent(double t_s) const;
  FilmState state_of(const Points3& places_m, double residual_strain) const;

  Choreography choreography_;
  scene::Cloth cloth_;
  std::vector<DistanceConstraint> rest_edges_;
  double fps_;
  std::optional<Welding> welding_;  ///< for a surface with seams
  bool is_stiff_;                   ///< not simulated
  std::vector<FilmState> states_;
};

}  // namespace weft::frex
