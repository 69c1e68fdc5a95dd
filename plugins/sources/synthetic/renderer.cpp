// SPDX-License-Identifier: Apache-2.0
#include "renderer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::synthetic {
namespace {

constexpr double kNearest_m = 0.01;
constexpr int kCellsAlongWidth = 180;
constexpr float kBack = 205.0F;
constexpr int kBackLevel = -1;

/// Light of a lamp behind the camera, up and to the left, and of its surroundings; at most 1.
double brightness(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d to_lamp = Eigen::Vector3d(-0.5, -0.5, -0.7).normalized();
  return 0.45 + 0.55 * std::abs(normal.dot(to_lamp));
}

}  // namespace

Texture::Texture(int width, int height, std::vector<float> pixels) {
  levels_.push_back({width, height, std::move(pixels)});
  while (levels_.back().width > 1 && levels_.back().height > 1) {
    levels_.push_back(halved(levels_.back()));
  }
}

Texture::Level Texture::halved(const Level& level) {
  Level half{level.width / 2, level.height / 2, {}};
  half.pixels.reserve(to_index(half.width) * to_index(half.height));
  const auto at = [&](int x, int y) {
    return level.pixels[to_index(y) * to_index(level.width) + to_index(x)];
  };
  for (int y = 0; y < half.height; ++y) {
    ask_to_go_on();
    for (int x = 0; x < half.width; ++x) {
      half.pixels.push_back(0.25F * (at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) +
                                     at(2 * x, 2 * y + 1) + at(2 * x + 1, 2 * y + 1)));
    }
  }
  return half;
}

float Texture::sample(int level, float u, float v) const {
  const Level& picture = levels_[to_index(level)];
  const float scale = 1.0F / static_cast<float>(1 << level);
  // Pixel centres are integers: the centre of a block of 2 x 2 is half a pixel from its first.
  const float a =
      std::clamp((u + 0.5F) * scale - 0.5F, 0.0F, static_cast<float>(picture.width - 1));
  const float b =
      std::clamp((v + 0.5F) * scale - 0.5F, 0.0F, static_cast<float>(picture.height - 1));
  const int i = std::min(static_cast<int>(a), std::max(0, picture.width - 2));
  const int j = std::min(static_cast<int>(b), std::max(0, picture.height - 2));
  const float s = a - static_cast<float>(i), t = b - static_cast<float>(j);
  const std::size_t right = picture.width > 1 ? 1 : 0;
  const auto width = to_index(picture.width);
  const float* first = picture.pixels.data() + to_index(j) * width + to_index(i);
  const float* second = picture.height > 1 ? first + width : first;
  return (1.0F - t) * ((1.0F - s) * first[0] + s * first[right]) +
         t * ((1.0F - s) * second[0] + s * second[right]);
}

Renderer::Renderer(const Camera& camera, Texture texture, Pitch pitch_m,
                   std::vector<float> background)
    : camera_(camera),
      texture_(std::move(texture)),
      pitch_m_(pitch_m),
      background_(std::move(background)) {
  const double width_m = pitch_m_[0] * texture_.width(), height_m = pitch_m_[1] * texture_.height();
  const double cells = std::clamp(kCellsAlongWidth * height_m / width_m, 8.0, 1000.0);
  columns_ = kCellsAlongWidth + 1;
  rows_ = static_cast<int>(std::lround(cells)) + 1;
  texels_per_cell_ = static_cast<double>(texture_.width()) * texture_.height() /
                     ((columns_ - 1.0) * (rows_ - 1.0));
}

void Renderer::project_mesh(const DevelopableSheet& sheet) {
  vertices_.clear();
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      const double u = static_cast<double>(i) * texture_.width() / (columns_ - 1) - 0.5;
      const double v = static_cast<double>(j) * texture_.height() / (rows_ - 1) - 0.5;
      const Eigen::Vector3d point = sheet.at(pitch_m_[0] * u, pitch_m_[1] * v);
      Vertex vertex{0.0, 0.0, {}, point.z() > kNearest_m};
      if (vertex.in_front) {
        const double near = 1.0 / point.z();
        // Ray k of pixel x looks at x + (k - 1) / 3 and is number 3 x + k.
        vertex.x = kRays * (camera_.fx * point.x() * near + camera_.cx) + 1.0;
        vertex.y = kRays * (camera_.fy * point.y() * near + camera_.cy) + 1.0;
        const double bright = brightness(sheet.normal(pitch_m_[0] * u, pitch_m_[1] * v));
        vertex.over_depth = {static_cast<float>(near), static_cast<float>(u * near),
                             static_cast<float>(v * near), static_cast<float>(bright * near)};
      }
      vertices_.push_back(vertex);
    }
  }
}

Renderer::Window Renderer::covered() const {
  const int width = kRays * static_cast<int>(camera_.width_px);
  const int height = kRays * static_cast<int>(camera_.height_px);
  double x0 = width, y0 = height, x1 = -1.0, y1 = -1.0;
  for (const Vertex& v : vertices_) {
    if (!v.in_front) continue;
    x0 = std::min(x0, v.x);
    y0 = std::min(y0, v.y);
    x1 = std::max(x1, v.x);
    y1 = std::max(y1, v.y);
  }
  // Whole pixels.
  const auto low = [](double value) {
    return kRays * static_cast<int>(std::max(0.0, std::floor(value / kRays)));
  };
  const auto high = [](double value, int size) {
    return static_cast<int>(std::clamp(kRays * (std::floor(value / kRays) + 1.0), 0.0, size * 1.0));
  };
  const Window window{low(x0), low(y0), high(x1, width), high(y1, height)};
  return window.x0 < window.x1 && window.y0 < window.y1 ? window : Window{};
}

const std::vector<float>& Renderer::render(const DevelopableSheet& sheet) {
  project_mesh(sheet);
  window_ = covered();
  const auto rays = to_index(window_.x1 - window_.x0) * to_index(window_.y1 - window_.y0);
  nearness_.assign(rays, 0.0F);
  grey_.resize(rays);
  for (int j = 0; j + 1 < rows_; ++j) {
    for (int i = 0; i + 1 < columns_; ++i) {
      const Vertex* top = vertices_.data() + static_cast<std::ptrdiff_t>(j) * columns_ + i;
      const Vertex* bottom = top + columns_;
      if (!top[0].in_front || !top[1].in_front || !bottom[0].in_front || !bottom[1].in_front) {
        continue;
      }
      draw_triangle(top[0], top[1], bottom[1]);
      draw_triangle(top[0], bottom[1], bottom[0]);
    }
  }
  resolve();
  return image_;
}

void Renderer::draw_triangle(const Vertex& a, const Vertex& b, const Vertex& c) {
  const double abx = b.x - a.x, aby = b.y - a.y, acx = c.x - a.x, acy = c.y - a.y;
  const double det = abx * acy - aby * acx;
  if (std::abs(det) < 1e-9) return;
  const int y0 = std::max(window_.y0, static_cast<int>(std::ceil(std::min({a.y, b.y, c.y}))));
  const int y1 = std::min(window_.y1 - 1, static_cast<int>(std::floor(std::max({a.y, b.y, c.y}))));
  const int x0 = std::max(window_.x0, static_cast<int>(std::ceil(std::min({a.x, b.x, c.x}))));
  const int x1 = std::min(window_.x1 - 1, static_cast<int>(std::floor(std::max({a.x, b.x, c.x}))));
  if (x0 > x1 || y0 > y1) return;

  // Weights of b and c grow by this from one ray to the next, along x and along y.
  const double b_x = acy / det, b_y = -acx / det, c_x = -aby / det, c_y = abx / det;
  const int level = det > 0.0 ? level_for(texels_per_cell_ / det) : kBackLevel;
  std::array<float, 4> step{};
  for (std::size_t k = 0; k < 4; ++k) {
    step[k] = static_cast<float>(b_x * (b.over_depth[k] - a.over_depth[k]) +
                                 c_x * (c.over_depth[k] - a.over_depth[k]));
  }
  for (int y = y0; y <= y1; ++y) {
    ask_to_go_on();
    const double b_row = (x0 - a.x) * b_x + (y - a.y) * b_y;
    const double c_row = (x0 - a.x) * c_x + (y - a.y) * c_y;
    const auto is_inside = [&](int n) {
      // Rays on a shared side belong to both triangles, so that rounding leaves no holes.
      constexpr double kSide = -1e-7;
      const double wb = b_row + n * b_x, wc = c_row + n * c_x;
      return wb >= kSide && wc >= kSide && wb + wc <= 1.0 - kSide;
    };
    int first = 0, last = x1 - x0;
    while (first <= last && !is_inside(first)) ++first;
    while (last > first && !is_inside(last)) --last;
    if (first > last) continue;
    const double wb = b_row + first * b_x, wc = c_row + first * c_x;
    std::array<float, 4> start{};
    for (std::size_t k = 0; k < 4; ++k) {
      start[k] = static_cast<float>(a.over_depth[k] + wb * (b.over_depth[k] - a.over_depth[k]) +
                                    wc * (c.over_depth[k] - a.over_depth[k]));
    }
    draw_row(y, x0 + first, x0 + last, start, step, level);
  }
}

int Renderer::level_for(double texels_per_ray) const {
  if (!(texels_per_ray > 2.0)) return 0;
  const int level = static_cast<int>(std::lround(0.5 * std::log2(texels_per_ray)));
  return std::min(level, texture_.level_count() - 1);
}

void Renderer::draw_row(int y, int x0, int x1, const std::array<float, 4>& start,
                        const std::array<float, 4>& step, int level) {
  const auto width = to_index(window_.x1 - window_.x0);
  const std::size_t row = to_index(y - window_.y0) * width;
  for (int x = x0; x <= x1; ++x) {
    const auto ray = row + to_index(x - window_.x0);
    const auto n = static_cast<float>(x - x0);
    const float near = start[0] + n * step[0];
    if (near <= nearness_[ray]) continue;
    nearness_[ray] = near;
    const float depth = 1.0F / near;
    const float paper = level == kBackLevel
                            ? kBack
                            : texture_.sample(level, depth * (start[1] + n * step[1]),
                                              depth * (start[2] + n * step[2]));
    grey_[ray] = paper * depth * (start[3] + n * step[3]);
  }
}

void Renderer::resolve() {
  image_ = background_;
  const auto stride = to_index(window_.x1 - window_.x0);
  const auto width = to_index(camera_.width_px);
  for (int y = window_.y0; y < window_.y1; y += kRays) {
    ask_to_go_on();
    for (int x = window_.x0; x < window_.x1; x += kRays) {
      float& pixel = image_[to_index(y / kRays) * width + to_index(x / kRays)];
      float sum = 0.0F;
      for (int k = 0; k < kRays * kRays; ++k) {
        const std::size_t ray =
            to_index(y - window_.y0 + k / kRays) * stride + to_index(x - window_.x0 + k % kRays);
        sum += nearness_[ray] > 0.0F ? grey_[ray] : pixel;
      }
      pixel = sum / static_cast<float>(kRays * kRays);
    }
  }
}

}  // namespace weft::synthetic
