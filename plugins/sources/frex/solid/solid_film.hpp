// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/geometry/distance_constraints.hpp>

#include "film/film.hpp"
#include "film/sways.hpp"
#include "solid/solid_rest.hpp"
#include "solid/space_map.hpp"

namespace weft::frex {

/// A solid that is deformed by a map of space and moves rigidly. At time 0 it is at rest, after
/// half a period the deformation is the whole one. Each frame is a function of its time alone.
class SolidFilm final : public Film {
 public:
  /// `view` turns the object at time 0, in the camera frame.
  static Result<std::unique_ptr<Film>> create(const SpaceMap::Settings& settings,
                                              const SwaySettings& sways, const SolidRest& rest,
                                              const Eigen::Matrix3d& view, double fps);

  Result<const FilmState*> at(std::int64_t index, const Call& call) override;

 private:
  SolidFilm(const SpaceMap& map, const SwaySettings& sways, const SolidRest& rest,
            std::vector<DistanceConstraint> rest_edges, const Eigen::Matrix3d& view, double fps,
            Rng rng);
  double amount_at(double t_s) const;

  SpaceMap map_;
  Sways sways_;
  double sign_;  ///< which way it is bent or twisted
  Points3 rest_m_;
  std::vector<DistanceConstraint> rest_edges_;  ///< edges of the truth's faces
  Eigen::Matrix3d view_;
  double fps_;
  FilmState state_;
};

}  // namespace weft::frex
