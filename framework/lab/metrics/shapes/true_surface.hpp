// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>
#include <weft/data/ground_truth.hpp>
#include <weft/geometry/types.hpp>

#include "lab/metrics/shapes/nearest.hpp"

namespace weft::lab {

/// A truth, or a part of one, whatever lies where on it.
struct TrueSurface {
  std::vector<Eigen::Vector3d> points_m;  ///< all, m, camera frame
  std::vector<Corners> faces;             ///< faces of the surface, where it is known
  std::vector<Eigen::Vector3d> loose_m;   ///< the points that are corners of no face
};

/// True points and cloud of a truth together; of one of its parts, where an index is given.
TrueSurface true_surface(const GroundTruth& truth, std::optional<std::int32_t> part = {});

/// The triangles of a mesh.
std::vector<Corners> corners_of(const Points3View& points, const FacesView& faces);

double area_of(const Corners& corners);

/// `count` points sampled uniformly by area; none if the triangles have no area. Two surfaces that
/// are compared need two seeds: with one, meshes of the same faces would have their samples at the
/// same places.
std::vector<Eigen::Vector3d> places_on(const std::vector<Corners>& triangles, std::int64_t count,
                                       std::uint64_t seed);

}  // namespace weft::lab
