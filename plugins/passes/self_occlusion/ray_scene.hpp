// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

namespace weft::self_occlusion {

/// Answers whether a triangle mesh stands between a camera at the origin and points, by Embree
/// (Wald et al., Embree: a kernel framework for efficient CPU ray tracing, 2014). Both sides of a
/// triangle block; triangles without area do not. Uses one thread.
class RayScene {
 public:
  /// Fails where Embree cannot be started.
  static Result<RayScene> create();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

  /// Replaces the mesh: vertices [V,3] m in the camera frame, finite, and faces in range.
  void set_mesh(const Points3View& vertices_m, const FacesView& faces);

  /// 1 for each of the points [N,3] m that something hides, more than `slack_m` before it.
  std::vector<std::uint8_t> are_hidden(const Points3View& points_m, double slack_m) const;

 private:
  struct Handles;
  explicit RayScene(std::unique_ptr<Handles> handles);

  std::unique_ptr<Handles> handles_;
};

}  // namespace weft::self_occlusion
