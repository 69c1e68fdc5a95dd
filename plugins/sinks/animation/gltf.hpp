// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/geometry/types.hpp>

namespace weft::animation {

/// Data that all frames of an animation share.
struct Scene {
  Faces faces;                            ///< [F,3] vertex indices
  std::vector<float> texture_uv;          ///< [2 V] from edge to edge of the texture, v downwards
  std::vector<std::uint8_t> texture_png;  ///< the file's bytes
  Camera camera;                          ///< the real one, without lens distortion
  double fps = 30.0;                      ///< [] 1/s
};

/// A frame of the run.
struct Frame {
  std::uint64_t number = 0;       ///< [] index from 0
  std::string name;               ///< "000012 estimated"
  std::vector<float> vertices_m;  ///< [3 V] m, camera frame; empty: the frame has no shape
  std::vector<float> normals;     ///< [3 V] of unit length; empty without a shape
};

/// Area-weighted normals [3 V] of unit length; those of vertices without a face point to the
/// camera.
std::vector<float> normals_of(const std::vector<float>& vertices_m, const Faces& faces);

/// A binary glTF 2.0 file (.glb) of frames in ascending order. At least one frame has a shape.
///
/// The mesh is the first shape; each later one is a morph target, and one animation gives one
/// target at a time the weight 1, without interpolation. During frames without a shape the mesh
/// keeps the last one and its node has the scale 0. The y axis is up: the node of the mesh turns
/// the camera frame by 180 degrees about x. The camera is at the origin and looks along -z.
std::string to_glb(const Scene& scene, const std::vector<Frame>& frames);

}  // namespace weft::animation
