// SPDX-License-Identifier: Apache-2.0
#include "kit/testing/geometry/moves.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/testing/role_contract.hpp>

namespace weft::testing {
namespace {

std::vector<std::int64_t> shuffled(std::int64_t count) {
  std::vector<std::int64_t> order(to_index(count));
  std::iota(order.begin(), order.end(), 0);
  Rng rng(kContractSeed);
  rng.shuffle(order);
  return order;
}

Eigen::Vector2d size_px(const Camera& camera) {
  return {static_cast<double>(camera.width_px), static_cast<double>(camera.height_px)};
}

}  // namespace

Move permute_matches(const Scene& scene) {
  return {.name = "matches permuted", .matches = shuffled(scene.matches.matches.count())};
}

Move repeat_matches(const Scene& scene) {
  Move move{.name = "matches given twice"};
  const std::int64_t count = scene.matches.matches.count();
  for (std::int64_t i = 0; i < count; ++i) move.matches.push_back(i);
  for (std::int64_t i = 0; i < count; i += 10) move.matches.push_back(i);
  return move;
}

Move shift_image() {
  Move move{.name = "image shifted"};
  move.image_shift_px = move.border_px = {48.0, 32.0};
  return move;
}

Move scale_image() {
  Move move{.name = "image scaled"};
  move.image = 2.0 * Eigen::Matrix2d::Identity();
  move.image_shift_px.setConstant(0.5);  // the corner of the first pixel stays at (-0.5, -0.5)
  return move;
}

Move roll_image(const Scene& scene) {
  Move move{.name = "image rolled"};
  move.image << 0.0, -1.0, 1.0, 0.0;
  move.image_shift_px.x() = size_px(scene.camera).y() - 1.0;
  move.space.topLeftCorner<2, 2>() = move.image;
  return move;
}

Move mirror_image(const Scene& scene) {
  Move move{.name = "image mirrored"};
  move.image(0, 0) = move.space(0, 0) = -1.0;
  move.image_shift_px.x() = size_px(scene.camera).x() - 1.0;
  move.mirrors_texture = true;
  return move;
}

Move scale_world() {
  return {.name = "world scaled", .space = 2.0 * Eigen::Matrix3d::Identity(), .metres = 2.0};
}

Move renumber_vertices(const Scene& scene) {
  return {.name = "vertices renumbered",
          .vertices = shuffled(scene.templ.vertices_m.rows()),
          .faces = shuffled(scene.templ.faces.rows())};
}

}  // namespace weft::testing
