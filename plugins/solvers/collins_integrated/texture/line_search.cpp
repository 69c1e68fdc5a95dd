// SPDX-License-Identifier: Apache-2.0
#include "line_search.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

namespace weft::collins_integrated {
namespace {

constexpr int kHalf = LineSearch::kSide / 2;
constexpr float kPixels = LineSearch::kSize;
constexpr float kNowhere = -2.0F;       // a score that no correlation has
constexpr float kPricePerPx = 0.01F;    // correlation that a pixel farther must gain
constexpr float kLeastContrast = 3.0F;  // grey levels, standard deviation of a patch
constexpr float kLeastInImage = 1.0F;   // the same of what is compared with it
constexpr double kFlattestView = 0.15;  // ratio of the two sides of a texel in the image, about

/// Beyond the border of the image, the value of the border.
float clamped_at(const Picture& picture, const Eigen::Vector2f& place) {
  const float right = static_cast<float>(picture.width) - 1.001F;
  const float bottom = static_cast<float>(picture.height) - 1.001F;
  return picture.at(std::clamp(place.x(), 0.0F, right), std::clamp(place.y(), 0.0F, bottom));
}

}  // namespace

void LineSearch::load(const Template& templ, const Pyramid& texture) {
  texture_ = &texture;
  faces_ = templ.faces.matrix<3>();
  const auto flat_px = templ.flat_px.matrix<2>();
  from_flat_.clear();
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    Eigen::Matrix2d sides_px;
    for (Eigen::Index k = 0; k < 2; ++k) {
      sides_px.col(k) = (flat_px.row(faces_(f, k + 1)) - flat_px.row(faces_(f, 0))).transpose();
    }
    const bool has_area = sides_px.determinant() != 0.0;
    from_flat_.push_back(has_area ? Eigen::Matrix2d(sides_px.inverse())
                                  : Eigen::Matrix2d(Eigen::Matrix2d::Zero()));
  }
  mask_ = Array<std::uint8_t>({templ.mask.dim(0), templ.mask.dim(1)});
  for (std::int64_t v = 0; v < mask_.dim(0); ++v) {
    std::copy_n(templ.mask.row(v), mask_.dim(1), mask_.row(v));
  }
}

/// False where the face does not show its front.
bool LineSearch::project(const Pinhole& camera, const Points3& vertices_m, const Sample& sample,
                         int level, LocalView& view) const {
  const Eigen::Vector3d a = vertices_m.row(faces_(sample.face, 0)).transpose();
  const Eigen::Vector3d b = vertices_m.row(faces_(sample.face, 1)).transpose();
  const Eigen::Vector3d c = vertices_m.row(faces_(sample.face, 2)).transpose();
  const Eigen::Vector3d point =
      sample.weights[0] * a + sample.weights[1] * b + sample.weights[2] * c;
  if (!(point.z() > 0.0)) return false;
  Eigen::Matrix<double, 3, 2> sides_m;
  sides_m << b - a, c - a;
  const double near = 1.0 / point.z(), x = point.x() * near, y = point.y() * near;
  Eigen::Matrix<double, 2, 3> slopes;  // derivative of the pixel, px/m
  slopes << camera.fx * near, 0.0, -camera.fx * near * x, 0.0, camera.fy * near,
      -camera.fy * near * y;
  const double level_scale = 1.0 / static_cast<double>(1 << level);
  const Eigen::Matrix2d px_per_texel =
      level_scale * slopes * sides_m * from_flat_[to_index(sample.face)];
  const double area = px_per_texel.determinant();
  if (!(area > 0.5 * kFlattestView * px_per_texel.squaredNorm())) return false;
  const double halvings = std::clamp(std::round(-0.5 * std::log2(area)), 0.0,
                                     static_cast<double>(texture_->levels()) - 1.0);
  const int texture_level = static_cast<int>(halvings);
  view.texture = &texture_->level(texture_level);
  view.scale = 1.0 / static_cast<double>(1 << texture_level);
  view.texels_per_px = (view.scale * px_per_texel.inverse()).cast<float>();
  view.place = Eigen::Vector2d(at_level(camera.fx * x + camera.cx, level),
                               at_level(camera.fy * y + camera.cy, level))
                   .cast<float>();
  view.texel = Eigen::Vector2d(at_level(sample.template_px.x(), texture_level),
                               at_level(sample.template_px.y(), texture_level))
                   .cast<float>();
  return true;
}

/// True if the corners of a patch belong to the object.
bool LineSearch::is_object(const LocalView& view) const {
  for (const float j : {-1.0F, 1.0F}) {
    for (const float i : {-1.0F, 1.0F}) {
      const Eigen::Vector2f corner =
          view.texel + static_cast<float>(kHalf) * (view.texels_per_px * Eigen::Vector2f(i, j));
      const Eigen::Array2d texel = (corner.cast<double>().array() + 0.5) / view.scale - 0.5;
      const auto u = std::llround(texel.x()), v = std::llround(texel.y());
      if (u < 0 || v < 0 || u >= mask_.dim(1) || v >= mask_.dim(0)) return false;
      if (mask_(v, u) == 0) return false;
    }
  }
  return true;
}

/// Eigenvector of the larger eigenvalue of the structure tensor over 3 x 3 pixels; 0 where nothing
/// changes.
Eigen::Vector2f LineSearch::normal_of(const LocalView& view) const {
  constexpr int kAcross = 5;
  std::array<float, kAcross * kAcross> grey{};
  for (int j = 0; j < kAcross; ++j) {
    for (int i = 0; i < kAcross; ++i) {
      const Eigen::Vector2f off(static_cast<float>(i - 2), static_cast<float>(j - 2));
      grey[to_index(j * kAcross + i)] =
          clamped_at(*view.texture, view.texel + view.texels_per_px * off);
    }
  }
  float xx = 0.0F, xy = 0.0F, yy = 0.0F;
  for (int j = 1; j + 1 < kAcross; ++j) {
    for (int i = 1; i + 1 < kAcross; ++i) {
      const std::size_t at = to_index(j * kAcross + i);
      const float dx = grey[at + 1] - grey[at - 1], dy = grey[at + kAcross] - grey[at - kAcross];
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  if (!(xx + yy > 0.0F)) return Eigen::Vector2f::Zero();
  const float turn_rad = 0.5F * std::atan2(2.0F * xy, xx - yy);
  return {std::cos(turn_rad), std::sin(turn_rad)};
}

/// False where the patch has no contrast.
bool LineSearch::draw(const LocalView& view, const Eigen::Vector2f& normal) {
  const Eigen::Vector2f along = view.texels_per_px * normal;
  const Eigen::Vector2f across = view.texels_per_px * Eigen::Vector2f(-normal.y(), normal.x());
  float sum = 0.0F;
  for (int a = 0; a < kSide; ++a) {
    for (int b = 0; b < kSide; ++b) {
      float& grey = patch_[to_index(a * kSide + b)];
      grey = clamped_at(*view.texture, view.texel + static_cast<float>(a - kHalf) * along +
                                           static_cast<float>(b - kHalf) * across);
      sum += grey;
    }
  }
  const float mean = sum / kPixels;
  float squares = 0.0F;
  for (float& grey : patch_) {
    grey -= mean;
    squares += grey * grey;
  }
  if (!(squares > kLeastContrast * kLeastContrast * kPixels)) return false;
  const float per_norm = 1.0F / std::sqrt(squares);
  for (float& grey : patch_) grey *= per_norm;
  return true;
}

/// Writes the scores of 2 reach + 1 shifts.
void LineSearch::correlate(const Picture& image, const LocalView& view,
                           const Eigen::Vector2f& normal, int reach_px) {
  const Eigen::Vector2f across(-normal.y(), normal.x());
  const int rows = kSide + 2 * reach_px;
  std::array<float, kSide + 2 * kMostReach> sums{}, squares{};
  std::array<bool, kSide + 2 * kMostReach> is_inside{};
  for (int a = 0; a < rows; ++a) {
    const Eigen::Vector2f middle = view.place + static_cast<float>(a - kHalf - reach_px) * normal;
    const Eigen::Vector2f first = middle - static_cast<float>(kHalf) * across;
    const Eigen::Vector2f last = middle + static_cast<float>(kHalf) * across;
    const auto row = to_index(a);
    is_inside[row] = image.holds(first.x(), first.y()) && image.holds(last.x(), last.y());
    if (!is_inside[row]) continue;
    for (int b = 0; b < kSide; ++b) {
      const Eigen::Vector2f place = middle + static_cast<float>(b - kHalf) * across;
      // Rounding may put what lies between two places inside a hair beyond the border.
      const float grey = clamped_at(image, place);
      strip_[to_index(a * kSide + b)] = grey;
      sums[row] += grey;
      squares[row] += grey * grey;
    }
  }
  for (int shift = 0; shift <= 2 * reach_px; ++shift) {
    float sum = 0.0F, square = 0.0F;
    bool all_inside = true;
    for (auto row = to_index(shift); row < to_index(shift + kSide); ++row) {
      all_inside = all_inside && is_inside[row];
      sum += sums[row];
      square += squares[row];
    }
    float& score = scores_[to_index(shift)];
    score = kNowhere;
    if (!all_inside) continue;
    const float* under = strip_.data() + to_index(shift * kSide);
    float alike = 0.0F;
    for (std::size_t k = 0; k < to_index(kSize); ++k) alike += patch_[k] * under[k];
    const float spread2 = square - sum * sum / kPixels;
    const bool has_contrast = spread2 > kLeastInImage * kLeastInImage * kPixels;
    score = has_contrast ? std::clamp(alike / std::sqrt(spread2), -1.0F, 1.0F) : 0.0F;
  }
}

Sighting LineSearch::look(const Pyramid& image, const Pinhole& camera, const Points3& vertices_m,
                          const Sample& sample, const LineSearchOptions& options) {
  Sighting sighting;
  LocalView view;
  if (!project(camera, vertices_m, sample, options.level, view)) return sighting;
  sighting.look = Look::outside;
  if (!is_object(view)) return sighting;
  const Eigen::Vector2f normal = normal_of(view);
  sighting.look = Look::flat;
  if (normal.isZero() || !draw(view, normal)) return sighting;
  correlate(image.level(options.level), view, normal, options.reach_px);
  const int reach = options.reach_px;
  const float here = scores_[to_index(reach)];
  sighting.look = Look::outside;
  if (here == kNowhere) return sighting;
  sighting.look = Look::unlike;
  sighting.zncc_here = here;
  int best = reach;
  for (int far = 1; far <= reach; ++far) {  // the nearer first
    for (const int shift : {reach - far, reach + far}) {
      const float gain = scores_[to_index(shift)] - scores_[to_index(best)];
      const auto farther = static_cast<float>(far - std::abs(best - reach));
      if (gain > kPricePerPx * farther) best = shift;
    }
  }
  sighting.zncc = scores_[to_index(best)];
  if (sighting.zncc < options.min_zncc || best == 0 || best == 2 * reach) return sighting;
  const float before = scores_[to_index(best - 1)], after = scores_[to_index(best + 1)];
  if (before == kNowhere || after == kNowhere) return sighting;
  const float bend = before - 2.0F * sighting.zncc + after;
  const float fraction =
      bend < 0.0F ? std::clamp(0.5F * (before - after) / bend, -0.5F, 0.5F) : 0.0F;
  const double level_scale = 1 << options.level;
  const double along_px =
      level_scale * static_cast<double>(static_cast<float>(best - reach) + fraction);
  const Eigen::Vector2d place_px =
      (level_scale * (view.place.cast<double>().array() + 0.5) - 0.5).matrix();
  sighting.normal = normal.cast<double>().normalized();
  sighting.seen_px = place_px + along_px * sighting.normal;
  sighting.look = Look::found;
  return sighting;
}

}  // namespace weft::collins_integrated
