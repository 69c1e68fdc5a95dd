// SPDX-License-Identifier: Apache-2.0
#include "scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/rectangular_grid.hpp>

namespace weft::frex_video {
namespace {

constexpr double kCell_mm = 2.5;  // of the mesh that is drawn
constexpr double kHidden_m = 0.003;

int vertices_along(double length_mm, double spacing_mm) {
  return std::max(2, static_cast<int>(std::ceil(length_mm / spacing_mm - 1e-9)) + 1);
}

}  // namespace

SceneMaker::SceneMaker(const MarkerSheet& sheet, scene::MipTexture texture, const Camera& camera,
                       const SceneOptions& options)
    : sheet_(sheet),
      camera_{camera.fx, camera.fy, camera.cx, camera.cy},
      options_(options),
      mm_per_px_(std::min(sheet.width_mm / texture.width(), sheet.height_mm / texture.height())),
      corner_mm_(0.5 * (sheet.width_mm - mm_per_px_ * texture.width()),
                 0.5 * (sheet.height_mm - mm_per_px_ * texture.height())),
      columns_(vertices_along(sheet.width_mm, kCell_mm)),
      rows_(vertices_along(sheet.height_mm, kCell_mm)),
      renderer_(std::move(texture),
                {static_cast<int>(camera.width_px), static_cast<int>(camera.height_px)},
                options.ambient) {}

Eigen::Vector2d SceneMaker::texture_size_m() const {
  return kMetre * mm_per_px_ *
         Eigen::Vector2d(renderer_.texture().width(), renderer_.texture().height());
}

Eigen::Vector2d SceneMaker::texel_at(const Eigen::Vector2d& point_mm) const {
  return ((point_mm - corner_mm_) / mm_per_px_).array() - 0.5;
}

Eigen::Vector2d SceneMaker::point_mm_of(const Eigen::Vector2d& texel) const {
  return corner_mm_ + (mm_per_px_ * (texel.array() + 0.5)).matrix();
}

Eigen::Vector3d SceneMaker::light_at(double t_s) const {
  constexpr double kLeastTilt_rad = 0.2, kMostTilt_rad = 0.9, kSway_rad = 0.15, kSway_s = 8.0;
  Rng rng(static_cast<std::uint64_t>(options_.lighting_seed));
  const double turn = rng.uniform(0.0, 2.0 * M_PI);
  const double tilt = rng.uniform(kLeastTilt_rad, kMostTilt_rad);
  const double now = turn + kSway_rad * std::sin(2.0 * M_PI * t_s / kSway_s);
  return {std::sin(tilt) * std::cos(now), std::sin(tilt) * std::sin(now), -std::cos(tilt)};
}

std::vector<ScreenVertex> SceneMaker::mesh(const LocatedSheet& sheet, double t_s) const {
  const Eigen::Vector3d light = light_at(t_s);
  std::vector<ScreenVertex> vertices;
  vertices.reserve(to_index(columns_) * to_index(rows_));
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      const Eigen::Vector2d p_mm(i * sheet_.width_mm / (columns_ - 1),
                                 j * sheet_.height_mm / (rows_ - 1));
      const Eigen::Vector3d point = sheet.surface.at(kMetre * p_mm);
      const Eigen::Vector2d pixel = project(camera_, point);
      const Eigen::Vector2d texel = texel_at(p_mm);
      vertices.push_back({pixel.x(), pixel.y(), point.z(), texel.x(), texel.y(),
                          sheet.surface.normal(kMetre * p_mm).dot(light)});
    }
  }
  return vertices;
}

Scene SceneMaker::make(const LocatedSheet& sheet, double t_s) const {
  Scene scene{renderer_.render(mesh(sheet, t_s), columns_), {}};
  scene.truth =
      options_.truth == Truth::surface ? surface_truth(sheet, scene.layer) : marker_truth(sheet);
  add_images(sheet, scene.layer, scene.truth);
  if (options_.blur_px > 0.0) {
    for (cv::Mat blurred :
         {static_cast<cv::Mat>(scene.layer.colour), static_cast<cv::Mat>(scene.layer.coverage)}) {
      cv::GaussianBlur(blurred, blurred, {0, 0}, options_.blur_px, 0.0, cv::BORDER_REPLICATE);
    }
  }
  return scene;
}

bool SceneMaker::is_visible(const Eigen::Vector3d& point_m, const Eigen::Vector3d& normal,
                            const SheetLayer& layer) const {
  if (normal.dot(point_m) >= 0.0) return false;
  const Eigen::Vector2d pixel = project(camera_, point_m);
  const double x = std::round(pixel.x()), y = std::round(pixel.y());
  if (!(x >= 0.0 && y >= 0.0 && x < layer.depth_m.cols && y < layer.depth_m.rows)) return false;
  const double seen_m = layer.depth_m(static_cast<int>(y), static_cast<int>(x));
  return seen_m == 0.0 || point_m.z() < seen_m + kHidden_m;
}

GroundTruth SceneMaker::surface_truth(const LocatedSheet& sheet, const SheetLayer& layer) const {
  const Eigen::Vector2d size_px(renderer_.texture().width(), renderer_.texture().height());
  const int columns = vertices_along(mm_per_px_ * size_px.x(), options_.truth_spacing_mm);
  const int rows = vertices_along(mm_per_px_ * size_px.y(), options_.truth_spacing_mm);
  std::vector<std::int32_t> number(to_index(columns) * to_index(rows), -1);
  std::vector<Eigen::Vector2d> texels;
  for (std::size_t k = 0; k < number.size(); ++k) {
    const std::size_t i = k % to_index(columns);
    const std::size_t j = k / to_index(columns);
    const Eigen::Vector2d texel(static_cast<double>(i) * size_px.x() / (columns - 1) - 0.5,
                                static_cast<double>(j) * size_px.y() / (rows - 1) - 0.5);
    if (!sheet.is_known(point_mm_of(texel))) continue;
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
    const Eigen::Vector2d p_m = kMetre * point_mm_of(texel);
    const Eigen::Vector3d point = sheet.surface.at(p_m);
    truth.template_xy_m.matrix<2>().row(k) = kMetre * mm_per_px_ * texel.transpose();
    truth.points_m.matrix<3>().row(k) = point.transpose();
    truth.visible(k) = is_visible(point, sheet.surface.normal(p_m), layer) ? 1 : 0;
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
    const Eigen::Vector2d inside = texel_at(sheet_.markers[seen.marker].centre_mm()).array() + 0.5;
    const bool is_on_texture = inside.minCoeff() >= 0.0 &&
                               inside.x() <= renderer_.texture().width() &&
                               inside.y() <= renderer_.texture().height();
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
        kMetre * mm_per_px_ * texel_at(sheet_.markers[seen.marker].centre_mm()).transpose();
    truth.points_m.matrix<3>().row(k) = sheet.rough_centres_m.row(i);
    truth.visible(k) = 1;
  }
  return truth;
}

void SceneMaker::add_images(const LocatedSheet& sheet, const SheetLayer& layer,
                            GroundTruth& truth) const {
  const std::int64_t height = layer.depth_m.rows, width = layer.depth_m.cols;
  truth.depth_m = Array<float>({height, width});
  truth.uv_m = Array<float>({height, width, 2});
  std::fill_n(truth.uv_m.data(), truth.uv_m.size(), std::numeric_limits<float>::quiet_NaN());
  for (int y = 0; y < height; ++y) {
    ask_to_go_on();
    for (int x = 0; x < width; ++x) {
      const cv::Vec2f& texel = layer.template_px(y, x);
      if (std::isnan(texel[0]) || !sheet.is_known(point_mm_of({texel[0], texel[1]}))) continue;
      truth.depth_m(y, x) = layer.depth_m(y, x);
      for (int k = 0; k < 2; ++k) {
        truth.uv_m(y, 2 * x + k) = static_cast<float>(kMetre * mm_per_px_ * texel[k]);
      }
    }
  }
}

}  // namespace weft::frex_video
