// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <weft/core/result.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/types.hpp>
#include <weft/sdk/call.hpp>

#include "common/scene/mip_texture.hpp"

namespace weft::frex {

/// One moment of the filmed object.
struct FilmState {
  Points3 vertices_m;  ///< [V,3] m, camera frame
  /// [] Largest strain of an edge against the length that it should have; none if the places are
  /// exact by construction.
  std::optional<double> residual_strain;
  StrainStatistics true_strain;  ///< strain of the edges against the object at rest: elasticity and
                                 ///< residue
};

/// The movement of an object. Each frame is the same for any order of requests.
class Film {
 public:
  virtual ~Film() = default;

  /// Frame `index` from 0, valid until the next call. Fails when the object cannot follow, or as
  /// soon as the call is cancelled.
  virtual Result<const FilmState*> at(std::int64_t index, const Call& call) = 0;
};

/// The filmed object. The points of its truth are the first of its vertices.
struct Subject {
  scene::MipTexture print;
  Points2 uv_px;               ///< [V,2] px of the texture
  Eigen::RowVector2d pitch_m;  ///< [2] m, size of a texel
  Faces faces;                 ///< [F,3] of the rendered surface
  Eigen::Index truth_points;   ///< [] T, number of the truth's points
  Faces truth_faces;           ///< [G,3] over the truth's points
  std::unique_ptr<Film> film;  ///< its states have V vertices
};

}  // namespace weft::frex
