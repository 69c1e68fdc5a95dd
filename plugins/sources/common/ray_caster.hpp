// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

namespace weft::sources {

/// A triangle mesh in the camera frame.
struct TriangleMesh {
  Points3 vertices_m;  ///< [V,3] m, camera frame
  Faces faces;         ///< [F,3] vertex indices
};

/// What a ray meets first.
struct RayHit {
  std::int32_t mesh = -1;  ///< [] index of the mesh, -1 for none
  std::int32_t face = -1;  ///< [] of that mesh
};

/// Which triangles a camera at the origin sees, by ray casting (Embree; Wald et al. 2014). Both
/// sides of a triangle are seen. Uses one thread.
class RayCaster {
 public:
  static Result<RayCaster> create();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;
  ~RayCaster();

  /// Replaces the meshes.
  void set_meshes(std::span<const TriangleMesh* const> meshes);

  /// The first triangle along each direction (any length); nothing nearer than 1 cm times the
  /// direction's length is seen.
  std::vector<RayHit> trace(std::span<const Eigen::Vector3f> directions) const;

  /// Whether something stands between the camera and each point [N,3] m, more than `slack_m` before
  /// the point.
  std::vector<std::uint8_t> are_hidden(const Points3View& points_m, double slack_m) const;

 private:
  struct Scene;
  explicit RayCaster(std::unique_ptr<Scene> scene);

  std::unique_ptr<Scene> scene_;
};

}  // namespace weft::sources
