// SPDX-License-Identifier: Apache-2.0
#include "texture_points.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>

#include "common/view/patch.hpp"
#include "common/view/picture.hpp"

namespace weft::track {
namespace {

constexpr int kMargin = 2;              // [px] from the border of the object
constexpr int kRadius = 3;              // [px] of the window of the structure tensor
constexpr float kLeastStrength = 1.0F;  // [(grey level/px)^2] mean over the window

/// How distinctive a place is in its surroundings: the smaller eigenvalue of the mean structure
/// tensor, 0 at the border.
view::Picture strength_of(const view::Picture& grey) {
  const int width = grey.width, height = grey.height;
  view::Picture xx, xy, yy, strength;
  for (view::Picture* picture : {&xx, &xy, &yy, &strength}) {
    picture->resize(width, height);
    std::fill(picture->values.begin(), picture->values.end(), 0.0F);
  }
  for (int y = 1; y + 1 < height; ++y) {
    worked(width);
    for (int x = 1; x + 1 < width; ++x) {
      const float dx = 0.5F * (grey.row(y)[x + 1] - grey.row(y)[x - 1]);
      const float dy = 0.5F * (grey.row(y + 1)[x] - grey.row(y - 1)[x]);
      xx.row(y)[x] = dx * dx;
      xy.row(y)[x] = dx * dy;
      yy.row(y)[x] = dy * dy;
    }
  }
  const float share = 1.0F / static_cast<float>((2 * kRadius + 1) * (2 * kRadius + 1));
  for (int y = kRadius; y + kRadius < height; ++y) {
    worked(width * 10);
    for (int x = kRadius; x + kRadius < width; ++x) {
      float a = 0.0F, b = 0.0F, c = 0.0F;
      for (int j = -kRadius; j <= kRadius; ++j) {
        for (int i = -kRadius; i <= kRadius; ++i) {
          a += xx.row(y + j)[x + i];
          b += xy.row(y + j)[x + i];
          c += yy.row(y + j)[x + i];
        }
      }
      const float root = std::sqrt(0.25F * (a - c) * (a - c) + b * b);
      strength.row(y)[x] = share * (0.5F * (a + c) - root);
    }
  }
  return strength;
}

/// 1 where all pixels within `margin` belong to the object and lie on its mesh.
std::vector<std::uint8_t> interior_of(const view::Picture& grey, const Template& templ,
                                      const FaceLocator& locator, int halvings, int margin) {
  const auto width = static_cast<std::ptrdiff_t>(grey.width);
  std::vector<std::uint8_t> inside(grey.values.size());
  const double scale = 1 << halvings;
  for (int y = 0; y < grey.height; ++y) {
    worked(10 * grey.width);
    for (int x = 0; x < grey.width; ++x) {
      const Eigen::Vector2d texel((x + 0.5) * scale - 0.5, (y + 0.5) * scale - 0.5);
      const auto u = std::min(std::llround(texel.x()), templ.mask.dim(1) - 1LL);
      const auto v = std::min(std::llround(texel.y()), templ.mask.dim(0) - 1LL);
      inside[to_index(y * width + x)] = templ.mask(v, u) != 0 && locator.locate(texel).inside;
    }
  }
  // Erosion along rows, then along columns: the run of ones that ends at a pixel must be long.
  const auto erode = [&](int lines, int length, std::ptrdiff_t line, std::ptrdiff_t step) {
    for (int k = 0; k < lines; ++k) {
      worked(length);
      std::uint8_t* first = inside.data() + k * line;
      int run = 0;
      for (int i = 0; i < length + margin; ++i) {
        run = i < length && first[i * step] != 0 ? run + 1 : 0;
        if (i >= margin) {
          std::uint8_t& pixel = first[(i - margin) * step];
          pixel = pixel != 0 && run >= 2 * margin + 1 ? 1 : 0;
        }
      }
    }
  };
  erode(grey.height, grey.width, width, 1);
  erode(grey.width, grey.height, 1, width);
  return inside;
}

double area_of(const Template& templ) {
  double area = 0.0;
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    Eigen::Matrix2d sides;
    for (int k = 0; k < 2; ++k) {
      sides.row(k) = templ.flat_px.matrix<2>().row(templ.faces(f, k + 1)) -
                     templ.flat_px.matrix<2>().row(templ.faces(f, 0));
    }
    area += 0.5 * std::abs(sides.determinant());
  }
  return area;
}

/// How often a texture is halved until the camera could see all of it at about this size.
int halvings_for(const Template& templ, const Camera& camera) {
  constexpr double kShareOfImage = 0.7;  // share of the image that a surface covers in typical
                                         // videos
  const double along_u =
      static_cast<double>(templ.texture.dim(1)) / static_cast<double>(camera.width_px);
  const double along_v =
      static_cast<double>(templ.texture.dim(0)) / static_cast<double>(camera.height_px);
  const double ratio = std::max(along_u, along_v) / kShareOfImage;
  return static_cast<int>(std::max(0.0, std::round(std::log2(ratio))));
}

}  // namespace

Result<void> TexturePoints::load(const Template& templ, const Camera& camera, int most) {
  const auto locator = FaceLocator::create(templ.flat_px.matrix<2>(), templ.faces.matrix<3>(), 0.0);
  if (!locator) return locator.error();
  view::Picture grey;
  view::read_grey(templ.texture, grey);
  int halvings = 0;
  for (const int wanted = halvings_for(templ, camera);
       halvings < wanted && std::min(grey.width, grey.height) > 4 * view::Patch::kSide;
       ++halvings) {
    view::Picture half;
    view::halve(grey, half);
    grey = std::move(half);
  }
  const view::Picture strength = strength_of(grey);
  const std::vector<std::uint8_t> inside = interior_of(grey, templ, *locator, halvings, kMargin);
  cell_px_ = std::sqrt(area_of(templ) / most);
  columns_ = static_cast<int>(std::ceil(static_cast<double>(templ.texture.dim(1)) / cell_px_));
  rows_ = static_cast<int>(std::ceil(static_cast<double>(templ.texture.dim(0)) / cell_px_));
  points_.assign(to_index(columns_) * to_index(rows_), {});
  std::vector<float> best(points_.size(), kLeastStrength);
  const double scale = 1 << halvings;
  for (int y = 0; y < grey.height; ++y) {
    worked(grey.width);
    for (int x = 0; x < grey.width; ++x) {
      if (inside[to_index(y) * to_index(grey.width) + to_index(x)] == 0) continue;
      const Eigen::Vector2d texel((x + 0.5) * scale - 0.5, (y + 0.5) * scale - 0.5);
      const auto cell = to_index(cell_of(texel));
      if (!(strength.row(y)[x] > best[cell])) continue;
      best[cell] = strength.row(y)[x];
      points_[cell].template_px = texel;
      points_[cell].face = 0;  // found below
    }
  }
  for (TexturePoint& point : points_) {
    if (point.face < 0) continue;
    const FaceLocation location = locator->locate(point.template_px);
    point.face = location.face;
    point.weights = location.weights;
  }
  return {};
}

int TexturePoints::cell_of(const Eigen::Vector2d& template_px) const {
  const auto along = [&](double place, int count) {
    return static_cast<int>(std::clamp(std::floor(place / cell_px_), 0.0, count - 1.0));
  };
  return along(template_px.y(), rows_) * columns_ + along(template_px.x(), columns_);
}

}  // namespace weft::track
