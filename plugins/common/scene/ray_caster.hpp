// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

namespace weft::scene {

/// A triangle mesh in the camera frame.
struct TriangleMesh {
  Points3 vertices_m;  ///< [V,3] m, camera frame
  Faces faces;         ///< [F,3] vertex indices
};

/// The first hit of a ray.
struct RayHit {
  std::int32_t mesh = -1;  ///< [] index of the mesh, -1 for none
  std::int32_t face = -1;  ///< [] of that mesh
};

/// Which triangles a camera at the origin sees, and what stands between it and points, by Embree
/// (Wald et al., Embree: a kernel framework for efficient CPU ray tracing, 2014). Both sides of a
/// triangle are seen and block; triangles without area do not. Uses one thread.
class RayCaster {
 public:
  /// Fails where Embree cannot be started.
  static Result<RayCaster> create();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;
  ~RayCaster();

  /// Replaces the meshes by one that serves for one frame: its tree is fast to build, not to trace.
  /// Vertices [V,3] m in the camera frame, finite, and faces in range.
  void set_mesh(const Points3View& vertices_m, const FacesView& faces);

  /// Replaces the meshes.
  void set_meshes(std::span<const TriangleMesh* const> meshes);

  /// The first triangle along each direction (any length); nothing nearer than 1 cm times the
  /// direction's length is seen.
  std::vector<RayHit> trace(std::span<const Eigen::Vector3f> directions) const;

  /// 1 for each of the points [N,3] m that something hides, more than `slack_m` before it.
  std::vector<std::uint8_t> are_hidden(const Points3View& points_m, double slack_m) const;

 private:
  struct Scene;
  explicit RayCaster(std::unique_ptr<Scene> scene);

  std::unique_ptr<Scene> scene_;
};

}  // namespace weft::scene
