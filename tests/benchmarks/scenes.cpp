// SPDX-License-Identifier: Apache-2.0
#include "scenes.hpp"

#include <algorithm>
#include <cmath>
#include <weft/data/matrix.hpp>

#include "component.hpp"

namespace weft::bench {
namespace {

constexpr std::uint64_t kSeed = 7;
constexpr double kRadiusM = 0.25, kRulingRad = 0.3;

Points3 bent(const Template& templ, const testing::SheetSpec& sheet, double radius_m,
             const testing::PoseSpec& pose) {
  return testing::bent_vertices(templ, testing::make_cylinder(sheet, radius_m, kRulingRad, pose));
}

Sightlines sightlines_of(const Points3& points_m, const Camera& camera) {
  const auto count = static_cast<std::int64_t>(points_m.rows());
  Sightlines lines;
  lines.vertex = Array<std::int32_t>({count}, 0);
  lines.face = Array<std::int32_t>({count}, 0);
  lines.barycentrics = Array<double>({count, 3}, 0.0);
  lines.pixel_px = Array<double>({count, 2}, 0.0);
  lines.ray = Array<double>({count, 3}, 0.0);
  lines.weight = Array<double>({count}, 0.0);
  lines.coverage = 1.0;
  for (std::int64_t i = 0; i < count; ++i) {
    const Eigen::RowVector3d point = points_m.row(i);
    lines.vertex(i) = static_cast<std::int32_t>(i);
    lines.face(i) = -1;
    lines.pixel_px(i, 0) = camera.fx * point.x() / point.z() + camera.cx;
    lines.pixel_px(i, 1) = camera.fy * point.y() / point.z() + camera.cy;
    for (int k = 0; k < 3; ++k) lines.ray(i, k) = point.normalized()[k];
    lines.weight(i) = 1.0;
  }
  return lines;
}

Shape shape_of(const Points3& vertices_m) {
  Shape shape;
  shape.vertices_m = make_array<double>(vertices_m);
  shape.state = static_cast<std::int32_t>(ShapeState::estimated);
  shape.confidence = 1.0;
  shape.source = Array<std::uint8_t>({vertices_m.rows()}, 0);
  std::fill_n(shape.source.data(), vertices_m.rows(), std::uint8_t{1});
  return shape;
}

}  // namespace

SheetScene::SheetScene(const testing::SheetSpec& sheet) : templ(testing::make_template(sheet)) {
  templ.revision = 1;
  truth_m = bent(templ, sheet, kRadiusM, {});
  testing::PoseSpec before;
  before.x_m = 0.004;
  before.tilt_x_rad = 0.03;
  previous = shape_of(bent(templ, sheet, 1.1 * kRadiusM, before));
  sightlines = sightlines_of(truth_m, camera);
}

Correspondences SheetScene::matches(int count, double correct_rate) const {
  Rng rng(kSeed);
  return testing::draw_matches(templ, camera, truth_m, {count, correct_rate, 0.5}, rng).matches;
}

Keypoints descriptors(int count, std::uint64_t seed) {
  constexpr int kLength = 128;
  Rng rng(seed);
  Keypoints keypoints;
  keypoints.xy_px = Array<double>({count, 2}, 0.0);
  keypoints.scale_px = Array<double>({count}, 0.0);
  keypoints.angle_rad = Array<double>({count}, 0.0);
  keypoints.response = Array<double>({count}, 0.0);
  keypoints.octave = Array<std::int32_t>({count}, 0);
  keypoints.metric = "l2";
  keypoints.descriptors = Array<float>({count, kLength}, 0.0F);
  keypoints.face = Array<std::int32_t>({count}, 0);
  keypoints.barycentrics = Array<double>({count, 3}, 0.0);
  for (int i = 0; i < count; ++i) {
    keypoints.xy_px(i, 0) = 640 * rng.uniform();
    keypoints.xy_px(i, 1) = 480 * rng.uniform();
    keypoints.scale_px(i) = 2.0;
    keypoints.barycentrics(i, 0) = 1.0;
    double squares = 0.0;
    for (int k = 0; k < kLength; ++k) {
      const double value = std::pow(rng.uniform(), 3.0);
      keypoints.descriptors(i, k) = static_cast<float>(value);
      squares += value * value;
    }
    const auto scale = static_cast<float>(512.0 / std::sqrt(squares));
    for (int k = 0; k < kLength; ++k) {
      keypoints.descriptors(i, k) = std::round(keypoints.descriptors(i, k) * scale);
    }
  }
  return keypoints;
}

Keypoints descriptors_seen(const Keypoints& templ, int count, std::uint64_t seed) {
  constexpr double kNoise = 4.0;
  Keypoints keypoints = descriptors(count, seed);
  Rng rng(seed + 1);
  for (std::int64_t i = 0; i < templ.count() / 2; ++i) {
    for (std::int64_t k = 0; k < templ.descriptors.dim(1); ++k) {
      const double value = templ.descriptors(i, k) + kNoise * rng.normal();
      keypoints.descriptors(i, k) = static_cast<float>(std::clamp(std::round(value), 0.0, 255.0));
    }
  }
  return keypoints;
}

host::RecordPtr synthetic_image() {
  const SheetScene scene;
  Component source("sources/synthetic", "{width_m: 0.297, texture: " WEFT_TEXTURE "}", scene.templ,
                   scene.camera);
  source.call({}, 0);
  return source.call({}, 2).find("image");
}

}  // namespace weft::bench
