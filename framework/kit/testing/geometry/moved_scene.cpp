// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

#include "kit/testing/contract_materials.hpp"
#include "kit/testing/geometry/moves.hpp"

namespace weft::testing {
namespace {

using Order = std::vector<std::int64_t>;

Order inverse(const Order& order) {
  Order places(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    places[to_index(order[i])] = static_cast<std::int64_t>(i);
  }
  return places;
}

/// Rows in this order, or a copy of all: arrays are shared by copies of their scene.
template <class T>
Array<T> reordered(const Array<T>& values, const Order& order) {
  if (!values.present() || values.ndim() == 0) return values;
  const std::int64_t rows = order.empty() ? values.rows() : static_cast<std::int64_t>(order.size());
  Array<T> result = values.ndim() == 3   ? Array<T>({rows, values.dim(1), values.dim(2)}, T{})
                    : values.ndim() == 2 ? Array<T>({rows, values.dim(1)}, T{})
                                         : Array<T>({rows}, T{});
  for (std::int64_t i = 0; i < rows; ++i) {
    std::copy_n(values.row(order.empty() ? i : order[to_index(i)]), values.row_elements(),
                result.row(i));
  }
  return result;
}

/// Indices of what was renumbered, -1 stays.
void rename(Array<std::int32_t>& indices, const Order& order) {
  const Order places = inverse(order);
  for (std::int64_t i = 0; !order.empty() && i < indices.size(); ++i) {
    std::int32_t& index = indices.data()[i];
    if (index >= 0) index = static_cast<std::int32_t>(places[to_index(index)]);
  }
}

/// Each pixel where the move brings it, the nearest one where it becomes larger; 0 in the border.
Array<std::uint8_t> moved_pixels(const Array<std::uint8_t>& pixels, const Camera& to,
                                 const Move& move) {
  Array<std::uint8_t> result({to.height_px, to.width_px}, 0);
  const Eigen::Matrix2d back = move.image.inverse();
  for (std::int64_t y = 0; y < to.height_px; ++y) {
    for (std::int64_t x = 0; x < to.width_px; ++x) {
      const Eigen::Vector2d place(static_cast<double>(x), static_cast<double>(y));
      const Eigen::Vector2d from = back * (place - move.image_shift_px);
      const std::int64_t column = std::llround(from.x()), row = std::llround(from.y());
      const bool inside = column >= 0 && row >= 0 && column < pixels.dim(1) && row < pixels.dim(0);
      if (inside) result(y, x) = pixels(row, column);
    }
  }
  return result;
}

Array<std::uint8_t> mirrored_texels(const Array<std::uint8_t>& texels) {
  Array<std::uint8_t> result = reordered(texels, {});
  for (std::int64_t v = 0; v < texels.dim(0); ++v) {
    std::reverse(result.row(v), result.row(v) + texels.dim(1));
  }
  return result;
}

/// A corner of each face changes places with another, so that it turns the way it did.
template <class T>
void turn_faces(Array<T>& corners) {
  for (std::int64_t f = 0; f < corners.rows(); ++f) std::swap(corners(f, 1), corners(f, 2));
}

double turned_angle(double angle_rad, const Move& move, bool is_difference) {
  if (move.mirrors_texture) angle_rad = is_difference ? -angle_rad : M_PI - angle_rad;
  if (!move.mirrors_texture) angle_rad += std::atan2(move.image(1, 0), move.image(0, 0));
  return std::remainder(angle_rad, 2.0 * M_PI);
}

Camera moved_camera(const Camera& camera, const Move& move) {
  const Eigen::Matrix2d size = move.image.cwiseAbs();
  const Eigen::Vector2d focal = size * Eigen::Vector2d(camera.fx, camera.fy);
  const Eigen::Vector2d centre =
      move.image * Eigen::Vector2d(camera.cx, camera.cy) + move.image_shift_px;
  const Eigen::Vector2d extent = size * Eigen::Vector2d(static_cast<double>(camera.width_px),
                                                        static_cast<double>(camera.height_px)) +
                                 move.border_px;
  return {focal.x(),
          focal.y(),
          centre.x(),
          centre.y(),
          std::llround(extent.x()),
          std::llround(extent.y())};
}

Template moved_template(const Template& templ, const Move& move) {
  Template result = templ;
  result.revision = templ.revision + 1;
  result.flat_px = reordered(
      make_array<double>(moved_texels(templ, templ.flat_px.matrix<2>(), move)), move.vertices);
  Points3 vertices_m = move.metres * templ.vertices_m.matrix<3>();
  if (move.mirrors_texture) {
    const double right_m =
        static_cast<double>(templ.texture.dim(1) - 1) * templ.m_per_px(0) * move.metres;
    vertices_m.col(0) = right_m - vertices_m.col(0).array();
    result.texture = mirrored_texels(templ.texture);
    result.mask = mirrored_texels(templ.mask);
  }
  result.vertices_m = reordered(make_array<double>(vertices_m), move.vertices);
  result.faces = reordered(templ.faces, move.faces);
  rename(result.faces, move.vertices);
  if (move.mirrors_texture) turn_faces(result.faces);
  result.m_per_px = reordered(templ.m_per_px, {});
  result.m_per_px.matrix<1>() *= move.metres;
  return result;
}

Keypoints moved_keypoints(const Keypoints& keypoints, const Template& templ, const Move& move,
                          bool of_image) {
  Keypoints result = keypoints;
  const Order& order = move.matches;
  const auto xy_px = keypoints.xy_px.matrix<2>();
  result.xy_px = reordered(
      make_array<double>(of_image ? move.in_image(xy_px) : moved_texels(templ, xy_px, move)),
      order);
  result.scale_px = reordered(keypoints.scale_px, order);
  if (of_image) result.scale_px.matrix<1>() *= move.pixels();
  result.angle_rad = reordered(keypoints.angle_rad, order);
  for (std::int64_t i = 0; (of_image || move.mirrors_texture) && i < result.count(); ++i) {
    result.angle_rad(i) = turned_angle(result.angle_rad(i), move, false);
  }
  result.response = reordered(keypoints.response, order);
  result.octave = reordered(keypoints.octave, order);
  result.descriptors = reordered(keypoints.descriptors, order);
  result.face = reordered(keypoints.face, order);
  result.barycentrics = reordered(keypoints.barycentrics, order);
  rename(result.face, move.faces);
  if (move.mirrors_texture) turn_faces(result.barycentrics);
  return result;
}

void move_matches(LabelledMatches& drawn, const Template& templ, const Move& move) {
  Correspondences& all = drawn.matches;
  const Order& order = move.matches;
  const Points2 image_px = move.in_image(all.image_px.matrix<2>());
  const Points2 texels_px = moved_texels(templ, all.template_px.matrix<2>(), move);
  all.image_px = make_array<double>(image_px);
  all.template_px = make_array<double>(texels_px);
  Correspondences::fields(all, [&]<class Values>(Values& values, const Field& /*field*/) {
    if constexpr (!std::is_same_v<Values, Diagnostics>) values = reordered(values, order);
  });
  rename(all.face, move.faces);
  if (move.mirrors_texture) turn_faces(all.barycentrics);
  all.scale_ratio.matrix<1>() *= move.pixels();
  for (std::int64_t i = 0; i < all.count(); ++i) {
    all.angle_difference_rad(i) = turned_angle(all.angle_difference_rad(i), move, true);
    all.template_keypoint(i) = all.image_keypoint(i) = static_cast<std::int32_t>(i);
  }
  const Points2 true_px = move.in_image(drawn.true_px);
  const std::vector<std::uint8_t> correct = drawn.correct;
  drawn.true_px.resize(all.count(), 2);
  drawn.correct.resize(to_index(all.count()));
  for (std::int64_t i = 0; i < all.count(); ++i) {
    drawn.true_px.row(i) = true_px.row(move.match(i));
    drawn.correct[to_index(i)] = correct[to_index(move.match(i))];
  }
}

void move_samples(WarpSamples& samples, const Move& move) {
  const double side = move.mirrors_texture ? -1.0 : 1.0;
  samples.xy_px =
      reordered(make_array<double>(move.in_image(samples.xy_px.matrix<2>())), move.vertices);
  samples.jacobian = reordered(samples.jacobian, move.vertices);
  samples.hessian = reordered(samples.hessian, move.vertices);
  for (std::int64_t i = 0; i < samples.xy_px.rows(); ++i) {
    Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> first(samples.jacobian.row(i));
    Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> second(samples.hessian.row(i));
    first = (move.image * first).eval();
    second = (move.image * second).eval();
    first.col(0) *= side;
    second.col(1) *= side;
  }
  samples.valid = reordered(samples.valid, move.vertices);
}

}  // namespace

Points2 moved_texels(const Template& templ, const Points2View& texels_px, const Move& move) {
  Points2 result = texels_px;
  if (move.mirrors_texture) {
    result.col(0) = static_cast<double>(templ.texture.dim(1) - 1) - result.col(0).array();
  }
  return result;
}

Scene moved(const Scene& scene, const Move& move) {
  Scene result = scene;
  result.camera = moved_camera(scene.camera, move);
  result.templ = moved_template(scene.templ, move);
  result.image.pixels = moved_pixels(scene.image.pixels, result.camera, move);
  result.region.mask = moved_pixels(scene.region.mask, result.camera, move);
  result.object_mask.foreground = moved_pixels(scene.object_mask.foreground, result.camera, move);
  result.object_mask.known = moved_pixels(scene.object_mask.known, result.camera, move);
  result.keypoints = moved_keypoints(scene.keypoints, scene.templ, move, true);
  result.template_keypoints = moved_keypoints(scene.template_keypoints, scene.templ, move, false);
  move_matches(result.matches, scene.templ, move);
  move_samples(result.warp_samples, move);
  result.visibility.visible = reordered(scene.visibility.visible, move.vertices);
  result.visibility.score = reordered(scene.visibility.score, move.vertices);
  result.visibility.reason = reordered(scene.visibility.reason, move.vertices);
  result.shape.vertices_m = reordered(
      make_array<double>(move.in_space(scene.shape.vertices_m.matrix<3>())), move.vertices);
  result.shape.source = reordered(scene.shape.source, move.vertices);
  result.known_points.vertex = reordered(scene.known_points.vertex, {});
  rename(result.known_points.vertex, move.vertices);
  result.known_points.points_m =
      make_array<double>(move.in_space(scene.known_points.points_m.matrix<3>()));
  result.known_points.radius_m = reordered(scene.known_points.radius_m, {});
  result.known_points.radius_m.matrix<1>() *= move.metres;
  result.ground_truth = truth_of(result.templ, result.shape.vertices_m.matrix<3>());
  result.follow_matches();
  return result;
}

}  // namespace weft::testing
