// SPDX-License-Identifier: Apache-2.0
#include "kit/testing/contract_scene.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/role_contract.hpp>

#include "kit/testing/contract_materials.hpp"

namespace weft::testing {
namespace {

constexpr SheetSpec kSheet{.columns = 9, .rows = 6, .width_px = 480, .height_px = 288};

template <class T>
Array<T> pick(const Array<T>& values, const std::vector<std::int64_t>& rows) {
  if (!values.present() || values.ndim() == 0) return values;
  const auto count = static_cast<std::int64_t>(rows.size());
  const std::int64_t width = values.row_elements();
  Array<T> picked = values.ndim() == 2 ? Array<T>({count, width}, 0) : Array<T>({count}, 0);
  for (std::int64_t i = 0; i < count; ++i) {
    std::copy_n(values.row(rows[to_index(i)]), width, picked.row(i));
  }
  return picked;
}

/// The first face that has this vertex, and its place there.
std::pair<std::int32_t, int> corner_of(const Template& templ, std::int64_t vertex) {
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (templ.faces(f, k) == vertex) return {static_cast<std::int32_t>(f), k};
    }
  }
  return {-1, 0};
}

/// Renders the surface over the image with the mean of the texels that fall on each pixel, because
/// the surface appears smaller than its texture.
void draw_sheet(const Template& templ, const Camera& camera, const DevelopableSheet& sheet,
                Array<std::uint8_t>& pixels) {
  std::vector<double> sum(to_index(pixels.size())), count(to_index(pixels.size()));
  for (std::int64_t v = 0; v < templ.texture.dim(0); ++v) {
    for (std::int64_t u = 0; u < templ.texture.dim(1); ++u) {
      const Eigen::Vector2d texel(static_cast<double>(u), static_cast<double>(v));
      const Eigen::Vector3d place =
          sheet.at(templ.m_per_px(0) * texel.x(), templ.m_per_px(1) * texel.y());
      const Eigen::Vector2d pixel = project(pinhole(camera), place);
      const std::int64_t x = std::llround(pixel.x()), y = std::llround(pixel.y());
      if (x < 0 || y < 0 || x >= camera.width_px || y >= camera.height_px) continue;
      const auto at = to_index(y * camera.width_px + x);
      sum[at] += templ.texture(v, u);
      count[at] += 1.0;
    }
  }
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (count[i] > 0.0)
      pixels.data()[i] = static_cast<std::uint8_t>(std::lround(sum[i] / count[i]));
  }
}

}  // namespace

void Scene::follow_matches() {
  const Correspondences& all = matches.matches;
  std::vector<std::int64_t> seen;
  for (std::int64_t i = 0; i < all.count(); ++i) {
    const bool usable = all.kept(i) != 0 && all.face(i) >= 0 && matches.correct[to_index(i)] != 0;
    if (usable) seen.push_back(i);
  }
  const auto count = static_cast<std::int64_t>(seen.size());
  sightlines.vertex = Array<std::int32_t>({count}, 0);
  std::fill_n(sightlines.vertex.data(), count, -1);
  sightlines.face = pick(all.face, seen);
  sightlines.barycentrics = pick(all.barycentrics, seen);
  sightlines.pixel_px = pick(all.image_px, seen);
  sightlines.ray = make_array<double>(unit_rays(pinhole(camera), sightlines.pixel_px.matrix<2>()));
  sightlines.weight = Array<double>({count}, 0.0);
  std::fill_n(sightlines.weight.data(), count, 1.0);
  sightlines.coverage = std::min(1.0, static_cast<double>(count) / 40.0);
  weights.weight = Array<double>({all.count()}, 0.0);
  std::fill_n(weights.weight.data(), all.count(), 0.75);
  ground_truth.match_xy_px = make_array<double>(matches.true_px);
  ground_truth.match_label = Array<std::int8_t>({all.count()}, 0);
  for (std::int64_t i = 0; i < all.count(); ++i) {
    ground_truth.match_label(i) = static_cast<std::int8_t>(matches.correct[to_index(i)]);
  }
}

void Scene::take_matches(const std::vector<std::int64_t>& rows) {
  Correspondences& all = matches.matches;
  Correspondences::fields(all, [&]<class Values>(Values& values, const Field& /*field*/) {
    if constexpr (!std::is_same_v<Values, Diagnostics>) values = pick(values, rows);
  });
  Points2 true_px(static_cast<Eigen::Index>(rows.size()), 2);
  std::vector<std::uint8_t> correct;
  for (const std::int64_t row : rows) {
    true_px.row(static_cast<Eigen::Index>(correct.size())) = matches.true_px.row(row);
    correct.push_back(matches.correct[to_index(row)]);
  }
  matches.true_px = true_px;
  matches.correct = correct;
  follow_matches();
}

void Scene::match_vertices(const std::vector<std::int64_t>& vertices) {
  take_matches(std::vector<std::int64_t>(vertices.size(), matches.matches.count() - 1));
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto row = static_cast<std::int64_t>(i);
    const auto [face, corner] = corner_of(templ, vertices[i]);
    Correspondences& all = matches.matches;
    all.template_px.matrix<2>().row(row) = templ.flat_px.matrix<2>().row(vertices[i]);
    const Eigen::Vector3d place = shape.vertices_m.matrix<3>().row(vertices[i]).transpose();
    matches.true_px.row(row) = project(pinhole(camera), place).transpose();
    all.image_px.matrix<2>().row(row) = matches.true_px.row(row);
    all.face(row) = face;
    for (int k = 0; k < 3; ++k) all.barycentrics(row, k) = k == corner ? 1.0 : 0.0;
    matches.correct[i] = 1;
  }
  follow_matches();
}

void Scene::reject_matches() {
  std::fill_n(matches.matches.kept.data(), matches.matches.count(), std::uint8_t{0});
  follow_matches();
}

void Scene::leave_the_mesh() {
  Correspondences& all = matches.matches;
  std::fill_n(all.face.data(), all.count(), -1);
  std::fill_n(all.barycentrics.data(), 3 * all.count(), 0.0);
  follow_matches();
}

HostRecord Scene::record(std::string_view slot) const {
  if (slot == "camera") return hold(camera);
  if (slot == "template") return hold(templ);
  if (slot == "image" || slot == "previous.image") return hold(image);
  if (slot == "region") return hold(region);
  if (slot == "object_mask") return hold(object_mask);
  if (slot == "time") return hold(time);
  if (slot == "keypoints") return hold(keypoints);
  if (slot == "template_keypoints") return hold(template_keypoints);
  if (slot == "correspondences" || slot == "previous.correspondences") return hold(matches.matches);
  if (slot == "weights") return hold(weights);
  if (slot == "warp_samples") return hold(warp_samples);
  if (slot == "sightlines") return hold(sightlines);
  if (slot == "visibility" || slot == "previous.visibility") return hold(visibility);
  if (slot == "shape" || slot == "previous.shape" || slot == "other_shape") return hold(shape);
  if (slot == "known_points") return hold(known_points);
  if (slot == "ground_truth") return hold(ground_truth);
  if (slot == "frame_report") return hold(frame_report);
  if (slot == "run_settings") return hold(run_settings);
  return nullptr;
}

Scene make_scene(int number, std::uint64_t seed) {
  return make_scene(number, {.count = 400 - 60 * number, .correct_rate = 0.85, .noise_px = 0.4}, 0,
                    seed);
}

Scene make_scene(int number, const MatchSpec& draw, int round, std::uint64_t seed) {
  Rng rng(seed + static_cast<std::uint64_t>(100 * number + 1000 * round));
  Scene scene;
  scene.camera = {410.0, 410.0, 159.5, 119.5, 320, 240};
  scene.templ = make_template(kSheet);
  scene.templ.revision = 1 + seed;
  Rng same_print(seed);
  draw_discs(scene.templ.texture, same_print);
  const double radius_m = number == 0 ? 0.3 : -0.45;
  const DevelopableSheet sheet =
      make_cylinder(kSheet, radius_m, 0.4 + number, {.distance_m = 0.65, .tilt_y_rad = 0.15});
  const Points3 vertices_m = bent_vertices(scene.templ, sheet);
  scene.ground_truth = truth_of(scene.templ, vertices_m);
  add_maps(scene.templ, scene.camera, sheet, scene.ground_truth);
  scene.matches = draw_matches(scene.templ, scene.camera, sheet, draw, rng);
  describe(scene.matches, rng);
  const Rng descriptors(seed);
  const Correspondences& all = scene.matches.matches;
  scene.template_keypoints = make_keypoints(all.template_px.matrix<2>(), descriptors, 0.0, Rng(2));
  scene.template_keypoints.face = all.face;
  scene.template_keypoints.barycentrics = all.barycentrics;
  scene.keypoints = make_keypoints(all.image_px.matrix<2>(), descriptors, 3.0, Rng(3));
  scene.warp_samples = sample_truth(scene.templ, scene.camera, sheet);
  scene.shape = shape_at(vertices_m);
  scene.visibility = all_visible(vertices_m.rows());
  scene.known_points = known_corners(vertices_m);
  scene.time.t_s = 0.04 * number;
  scene.image.stem = number == 0 ? "000000" : "000001";
  scene.image.pixels = Array<std::uint8_t>({scene.camera.height_px, scene.camera.width_px}, 0);
  draw_discs(scene.image.pixels, rng);
  draw_sheet(scene.templ, scene.camera, sheet, scene.image.pixels);
  scene.region.mask = Array<std::uint8_t>({scene.camera.height_px, scene.camera.width_px}, 0);
  for (std::int64_t y = 0; y < scene.camera.height_px; ++y) {
    std::fill_n(scene.region.mask.row(y), scene.camera.width_px / 2, std::uint8_t{1});
  }
  scene.object_mask = mask_of(scene.templ, scene.camera, sheet);
  scene.frame_report.json = R"({"frame":0,"state":"estimated","age":0,"stages":[]})";
  scene.run_settings.json = R"({"stages":[]})";
  scene.follow_matches();
  return scene;
}

}  // namespace weft::testing
