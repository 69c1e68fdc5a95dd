// SPDX-License-Identifier: Apache-2.0
#include "scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/rectangular_grid.hpp>

namespace weft::frex_video {
namespace {

constexpr double kCell_mm = 2.5;  // cells of the rendered mesh
constexpr double kHidden_m = 0.003;
constexpr scene::Paper kWhitePaper{255.0F, 255.0F};

int vertices_along(double length_mm, double spacing_mm) {
  return std::max(2, static_cast<int>(std::ceil(length_mm / spacing_mm - 1e-9)) + 1);
}

}  // namespace

Eigen::Vector2d SceneMaker::Place::texel_at(const Eigen::Vector2d& point_mm) const {
  return ((point_mm - corner_mm) / mm_per_px).array() - 0.5;
}

Eigen::Vector2d SceneMaker::Place::point_mm_of(const Eigen::Vector2d& texel) const {
  return corner_mm + (mm_per_px * (texel.array() + 0.5)).matrix();
}

Result<SceneMaker> SceneMaker::create(const MarkerSheet& sheet, scene::MipTexture texture,
                                      const Camera& camera, const SceneOptions& options) {
  const double mm_per_px =
      std::min(sheet.width_mm / texture.width(), sheet.height_mm / texture.height());
  const Place place{mm_per_px,
                    {0.5 * (sheet.width_mm - mm_per_px * texture.width()),
                     0.5 * (sheet.height_mm - mm_per_px * texture.height())}};
  const int columns = vertices_along(sheet.width_mm, kCell_mm);
  const int rows = vertices_along(sheet.height_mm, kCell_mm);
  Points2 mesh_mm(Eigen::Index{columns} * rows, 2), uv_px(Eigen::Index{columns} * rows, 2);
  for (Eigen::Index v = 0; v < mesh_mm.rows(); ++v) {
    const Eigen::Index row = v / columns;
    mesh_mm.row(v) << static_cast<double>(v % columns) * sheet.width_mm / (columns - 1),
        static_cast<double>(row) * sheet.height_mm / (rows - 1);
    uv_px.row(v) = place.texel_at(mesh_mm.row(v).transpose()).transpose();
  }
  const auto faces = rectangular_grid_faces(columns, rows);
  if (!faces) return faces.error();
  scene::Picture nothing{static_cast<int>(camera.width_px), static_cast<int>(camera.height_px)};
  nothing.pixels.resize(to_index(nothing.width) * to_index(nothing.height), scene::Colour::Zero());
  auto renderer = scene::SheetRenderer::create(camera, std::move(texture), uv_px, *faces,
                                               std::move(nothing), kWhitePaper);
  if (!renderer) return renderer.error();
  return SceneMaker(sheet, place, camera, options, std::move(mesh_mm), *std::move(renderer));
}

SceneMaker::SceneMaker(const MarkerSheet& sheet, const Place& place, const Camera& camera,
                       const SceneOptions& options, Points2 mesh_mm, scene::SheetRenderer renderer)
    : sheet_(sheet),
      camera_{camera.fx, camera.fy, camera.cx, camera.cy},
      options_(options),
      place_(place),
      mesh_mm_(std::move(mesh_mm)),
      renderer_(std::move(renderer)) {}

Eigen::Vector2d SceneMaker::texture_size_m() const {
  return kMetre * place_.mm_per_px *
         Eigen::Vector2d(renderer_.print().width(), renderer_.print().height());
}

Eigen::Vector3d SceneMaker::light_at(double t_s) const {
  constexpr double kLeastTilt_rad = 0.2, kMostTilt_rad = 0.9, kSway_rad = 0.15, kSway_s = 8.0;
  Rng rng(static_cast<std::uint64_t>(options_.lighting_seed));
  const double turn = rng.uniform(0.0, 2.0 * M_PI);
  const double tilt = rng.uniform(kLeastTilt_rad, kMostTilt_rad);
  const double now = turn + kSway_rad * std::sin(2.0 * M_PI * t_s / kSway_s);
  return {std::sin(tilt) * std::cos(now), std::sin(tilt) * std::sin(now), -std::cos(tilt)};
}

Points3 SceneMaker::vertices_m(const LocatedSheet& sheet) const {
  Points3 vertices_m(mesh_mm_.rows(), 3);
  for (Eigen::Index v = 0; v < mesh_mm_.rows(); ++v) {
    vertices_m.row(v) = sheet.surface.at(kMetre * mesh_mm_.row(v).transpose()).transpose();
  }
  return vertices_m;
}

Scene SceneMaker::make(const LocatedSheet& sheet, double t_s) {
  const scene::View view = renderer_.render(vertices_m(sheet), {light_at(t_s), options_.ambient},
                                            std::nullopt, scene::SheetRenderer::Scope::pixels);
  Scene scene{layer_of(view), {}};
  scene.truth = options_.truth == Truth::surface ? surface_truth(sheet, view) : marker_truth(sheet);
  add_images(sheet, view, scene.truth);
  return scene;
}

cv::Mat4f SceneMaker::layer_of(const scene::View& view) const {
  cv::Mat4f layer(view.image.height, view.image.width);
  for (int y = 0; y < layer.rows; ++y) {
    ask_to_go_on();
    for (int x = 0; x < layer.cols; ++x) {
      const scene::Colour& colour = view.image.at(x, y);
      layer(y, x) = {colour[0], colour[1], colour[2], view.coverage(y, x)};
    }
  }
  if (options_.blur_px > 0.0) {
    cv::GaussianBlur(layer, layer, {0, 0}, options_.blur_px, 0.0, cv::BORDER_REPLICATE);
  }
  return layer;
}

bool SceneMaker::is_visible(const Eigen::Vector3d& point_m, const Eigen::Vector3d& normal,
                            const scene::View& view) const {
  if (normal.dot(point_m) >= 0.0) return false;
  const Eigen::Vector2d pixel = project(camera_, point_m);
  const double x = std::round(pixel.x()), y = std::round(pixel.y());
  if (!(x >= 0.0 && y >= 0.0 && x < view.image.width && y < view.image.height)) return false;
  const double seen_m = view.depth_m(static_cast<int>(y), static_cast<int>(x));
  return seen_m == 0.0 || point_m.z() < seen_m + kHidden_m;
}

GroundTruth SceneMaker::surface_truth(const LocatedSheet& sheet, const scene::View& view) const {
  const Eigen::Vector2d size_px(renderer_.print().width(), renderer_.print().height());
  const int columns = vertices_along(place_.mm_per_px * size_px.x(), options_.truth_spacing_mm);
  const int rows = vertices_along(place_.mm_per_px * size_px.y(), options_.truth_spacing_mm);
  std::vector<std::int32_t> number(to_index(columns) * to_index(rows), -1);
  std::vector<Eigen::Vector2d> texels;
  for (std::size_t k = 0; k < number.size(); ++k) {
    const std::size_t i = k % to_index(columns);
    const std::size_t j = k / to_index(columns);
    const Eigen::Vector2d texel(static_cast<double>(i) * size_px.x() / (columns - 1) - 0.5,
                                static_cast<double>(j) * size_px.y() / (rows - 1) - 0.5);
    if (!sheet.is_known(place_.point_mm_of(texel))) continue;
    number[k] = static_cast<std::int32_t>(texels.size());
    texels.push_back(texel);
  }

  const auto count = static_cast<std::int64_t>(texels.size());
  GroundTruth truth;
  truth.kind = "surface";
  truth.template_xy_m = Array<double>({count, 2});
  truth.points_m = Array<double>({count, 3});
  truth.visible = Array<std::uint8_t>({count});
  for (std::int64_t k = 0; k < count; ++k) {
    const Eigen::Vector2d& texel = texels[to_index(k)];
    const Eigen::Vector2d p_m = kMetre * place_.point_mm_of(texel);
    const Eigen::Vector3d point = sheet.surface.at(p_m);
    truth.template_xy_m.matrix<2>().row(k) = kMetre * place_.mm_per_px * texel.transpose();
    truth.points_m.matrix<3>().row(k) = point.transpose();
    truth.visible(k) = is_visible(point, sheet.surface.normal(p_m), view) ? 1 : 0;
  }
  std::vector<std::array<std::int32_t, 3>> faces;
  const auto grid = rectangular_grid_faces(columns, rows);
  for (Eigen::Index f = 0; f < grid->rows(); ++f) {
    std::array<std::int32_t, 3> face{};
    for (int k = 0; k < 3; ++k) {
      face[to_index(k)] = number[to_index((*grid)(f, k))];
    }
    if (*std::min_element(face.begin(), face.end()) >= 0) faces.push_back(face);
  }
  truth.faces = Array<std::int32_t>({static_cast<std::int64_t>(faces.size()), 3});
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::copy(faces[f].begin(), faces[f].end(), truth.faces.row(static_cast<std::int64_t>(f)));
  }
  return truth;
}

GroundTruth SceneMaker::marker_truth(const LocatedSheet& sheet) const {
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < sheet.rough_centres_m.rows(); ++i) {
    const SeenMarker& seen = sheet.warp.markers[to_index(i)];
    const Eigen::Vector2d inside =
        place_.texel_at(sheet_.markers[seen.marker].centre_mm()).array() + 0.5;
    const bool is_on_texture = inside.minCoeff() >= 0.0 &&
                               inside.x() <= renderer_.print().width() &&
                               inside.y() <= renderer_.print().height();
    if (is_on_texture && sheet.rough_centres_m.row(i).allFinite()) known.push_back(i);
  }
  const auto count = static_cast<std::int64_t>(known.size());
  GroundTruth truth;
  truth.kind = "markers";
  truth.template_xy_m = Array<double>({count, 2});
  truth.points_m = Array<double>({count, 3});
  truth.visible = Array<std::uint8_t>({count});
  for (std::int64_t k = 0; k < count; ++k) {
    const Eigen::Index i = known[to_index(k)];
    const SeenMarker& seen = sheet.warp.markers[to_index(i)];
    truth.template_xy_m.matrix<2>().row(k) =
        kMetre * place_.mm_per_px *
        place_.texel_at(sheet_.markers[seen.marker].centre_mm()).transpose();
    truth.points_m.matrix<3>().row(k) = sheet.rough_centres_m.row(i);
    truth.visible(k) = 1;
  }
  return truth;
}

void SceneMaker::add_images(const LocatedSheet& sheet, const scene::View& view,
                            GroundTruth& truth) const {
  const std::int64_t height = view.image.height, width = view.image.width;
  truth.depth_m = Array<float>({height, width}, 0.0F);
  truth.uv_m = Array<float>({height, width, 2}, std::numeric_limits<float>::quiet_NaN());
  for (int y = 0; y < height; ++y) {
    ask_to_go_on();
    for (int x = 0; x < width; ++x) {
      const Eigen::Vector2d texel =
          Eigen::Map<const Eigen::Vector2f>(view.uv_px.row(y) + std::ptrdiff_t{2} * x)
              .cast<double>();
      if (std::isnan(texel[0]) || !sheet.is_known(place_.point_mm_of(texel))) continue;
      truth.depth_m(y, x) = view.depth_m(y, x);
      for (int k = 0; k < 2; ++k) {
        truth.uv_m(y, 2 * x + k) = static_cast<float>(kMetre * place_.mm_per_px * texel[k]);
      }
    }
  }
}

}  // namespace weft::frex_video
