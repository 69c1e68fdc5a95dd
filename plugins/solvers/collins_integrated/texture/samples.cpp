// SPDX-License-Identifier: Apache-2.0
#include "samples.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/mesh_validation.hpp>

namespace weft::collins_integrated {
namespace {

constexpr double kShareOfImage = 0.7;
constexpr float kLeastSlope = 3.0F;  // grey levels a px
constexpr int kMargin = 4;           // px

/// How often the texture is halved until the camera sees it at about this size.
int halvings_for(const Template& templ, const Camera& camera) {
  const double along_u =
      static_cast<double>(templ.texture.dim(1)) / static_cast<double>(camera.width_px);
  const double along_v =
      static_cast<double>(templ.texture.dim(0)) / static_cast<double>(camera.height_px);
  const double ratio = std::max(along_u, along_v) / kShareOfImage;
  return ratio > 1.0 ? static_cast<int>(std::lround(std::log2(ratio))) : 0;
}

double area_px2(const Template& templ) {
  double area = 0.0;
  const auto flat_px = templ.flat_px.matrix<2>();
  const auto faces = templ.faces.matrix<3>();
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    area += std::abs(signed_area_px2(flat_px, faces, f));
  }
  return area;
}

/// In px of the texture.
Eigen::Vector2d texel_at(int x, int y, double scale) {
  return {(x + 0.5) * scale - 0.5, (y + 0.5) * scale - 0.5};
}

bool belongs(const Template& templ, const FaceLocator& locator, const Eigen::Vector2d& texel) {
  const auto u = std::llround(texel.x()), v = std::llround(texel.y());
  if (u < 0 || v < 0 || u >= templ.mask.dim(1) || v >= templ.mask.dim(0)) return false;
  return templ.mask(v, u) != 0 && locator.locate(texel).inside;
}

/// Checks the corners and the middles of the sides of a square, and its centre.
bool all_belongs(const Template& templ, const FaceLocator& locator, int x, int y, double scale) {
  for (int j = -kMargin; j <= kMargin; j += kMargin) {
    for (int i = -kMargin; i <= kMargin; i += kMargin) {
      worked(10);
      if (!belongs(templ, locator, texel_at(x + i, y + j, scale))) return false;
    }
  }
  return true;
}

}  // namespace

Result<void> choose_samples(const Template& templ, const Pyramid& texture, const Camera& camera,
                            int most, std::vector<Sample>& samples) {
  const auto locator = FaceLocator::create(templ.flat_px.matrix<2>(), templ.faces.matrix<3>(), 0.0);
  if (!locator) return locator.error();
  const int halvings = std::min(halvings_for(templ, camera), texture.levels() - 1);
  const Picture& grey = texture.level(halvings);
  const double scale = 1 << halvings;
  const double cell_px = std::max(std::sqrt(area_px2(templ) / most), 1.0);
  const int columns =
      static_cast<int>(std::ceil(static_cast<double>(templ.texture.dim(1)) / cell_px));
  const int rows = static_cast<int>(std::ceil(static_cast<double>(templ.texture.dim(0)) / cell_px));
  const auto cell_along = [&](double place_px, int count) {
    return std::clamp(static_cast<int>(std::floor(place_px / cell_px)), 0, count - 1);
  };
  std::vector<float> steepest(to_index(columns) * to_index(rows), kLeastSlope * kLeastSlope);
  std::vector<Sample> of_cell(steepest.size());
  for (int y = 1; y + 1 < grey.height; ++y) {
    worked(grey.width);
    const float* above = grey.row(y - 1);
    const float* here = grey.row(y);
    const float* below = grey.row(y + 1);
    for (int x = 1; x + 1 < grey.width; ++x) {
      const float dx = 0.5F * (here[x + 1] - here[x - 1]), dy = 0.5F * (below[x] - above[x]);
      const float slope2 = dx * dx + dy * dy;
      if (!(slope2 > kLeastSlope * kLeastSlope)) continue;
      const Eigen::Vector2d texel = texel_at(x, y, scale);
      const auto cell = to_index(cell_along(texel.y(), rows)) * to_index(columns) +
                        to_index(cell_along(texel.x(), columns));
      if (!(slope2 > steepest[cell]) || !all_belongs(templ, *locator, x, y, scale)) continue;
      steepest[cell] = slope2;
      of_cell[cell].template_px = texel;
      of_cell[cell].face = 0;  // found below
    }
  }
  samples.clear();
  for (Sample& sample : of_cell) {
    if (sample.face < 0) continue;
    const FaceLocation place = locator->locate(sample.template_px);
    sample.face = place.face;
    sample.weights = place.weights;
    samples.push_back(sample);
  }
  return {};
}

}  // namespace weft::collins_integrated
