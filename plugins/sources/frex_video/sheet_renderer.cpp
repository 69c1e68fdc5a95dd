// SPDX-License-Identifier: Apache-2.0
#include "sheet_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::frex_video {
namespace {

constexpr int kRays = SheetRenderer::kRays;
constexpr float kPaper = 255.0F;
constexpr float kBack = -1.0F;  // pitch of rays that see the back

/// What the nearest surface is on one ray.
struct Ray {
  float nearness = 0.0F;  // 1/m; 0 where there is none
  float u = 0.0F, v = 0.0F, light = 0.0F;
  float pitch = 0.0F;  // texels between rays
};

/// The rays of the part of the image that the sheet covers.
class RayGrid {
 public:
  RayGrid(const std::vector<ScreenVertex>& mesh, const cv::Size& image_px) {
    double x0 = image_px.width, y0 = image_px.height, x1 = -1.0, y1 = -1.0;
    for (const ScreenVertex& vertex : mesh) {
      x0 = std::min(x0, vertex.x_px);
      y0 = std::min(y0, vertex.y_px);
      x1 = std::max(x1, vertex.x_px);
      y1 = std::max(y1, vertex.y_px);
    }
    const auto pixel = [](double value, int size) {
      return static_cast<int>(std::clamp(std::floor(value + 0.5), 0.0, static_cast<double>(size)));
    };
    const cv::Point first(pixel(x0, image_px.width), pixel(y0, image_px.height));
    const cv::Point end(pixel(x1 + 1.0, image_px.width), pixel(y1 + 1.0, image_px.height));
    if (first.x < end.x && first.y < end.y) window_ = {first, end};
    width_ = kRays * window_.width;
    height_ = kRays * window_.height;
    rays_.resize(to_index(width_) * to_index(height_));
  }

  const cv::Rect& window_px() const { return window_; }

  /// Ray (kx,ky) of the pixel (x,y) of the image.
  const Ray& at(int x, int y, int kx, int ky) const {
    return ray(kRays * (x - window_.x) + kx, kRays * (y - window_.y) + ky);
  }

  void draw(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
    const Corner p = corner(a), q = corner(b), r = corner(c);
    const double abx = q.x - p.x, aby = q.y - p.y, acx = r.x - p.x, acy = r.y - p.y;
    const double det = abx * acy - aby * acx;
    if (!(std::abs(det) > 1e-9)) return;
    const double texels =
        std::abs((b.u_px - a.u_px) * (c.v_px - a.v_px) - (b.v_px - a.v_px) * (c.u_px - a.u_px));
    const float pitch = det > 0.0 ? static_cast<float>(std::sqrt(texels / det)) : kBack;
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({p.x, q.x, r.x}))));
    const int y0 = std::max(0, static_cast<int>(std::ceil(std::min({p.y, q.y, r.y}))));
    const int x1 = std::min(width_ - 1, static_cast<int>(std::floor(std::max({p.x, q.x, r.x}))));
    const int y1 = std::min(height_ - 1, static_cast<int>(std::floor(std::max({p.y, q.y, r.y}))));
    for (int y = y0; y <= y1; ++y) {
      ask_to_go_on();
      for (int x = x0; x <= x1; ++x) {
        const double beta = ((x - p.x) * acy - (y - p.y) * acx) / det;
        const double gamma = ((y - p.y) * abx - (x - p.x) * aby) / det;
        // Rays on a shared side belong to both triangles, so that rounding leaves no holes.
        constexpr double kSide = -1e-7;
        if (beta < kSide || gamma < kSide || beta + gamma > 1.0 - kSide) continue;
        meet(x, y, mixed(p, q, r, beta, gamma), pitch);
      }
    }
  }

 private:
  /// Place in units of rays, and what is linear there: 1/z, u/z, v/z and light/z.
  struct Corner {
    double x, y;
    std::array<double, 4> over_depth;
  };

  const Ray& ray(int x, int y) const { return rays_[to_index(y) * to_index(width_) + to_index(x)]; }

  Corner corner(const ScreenVertex& vertex) const {
    const double near = 1.0 / vertex.depth_m;
    // Ray k of pixel x looks at x + (k - 1) / 3.
    return {kRays * (vertex.x_px - window_.x) + 1.0,
            kRays * (vertex.y_px - window_.y) + 1.0,
            {near, vertex.u_px * near, vertex.v_px * near, vertex.light * near}};
  }

  static std::array<double, 4> mixed(const Corner& a, const Corner& b, const Corner& c, double beta,
                                     double gamma) {
    std::array<double, 4> sum{};
    for (std::size_t k = 0; k < 4; ++k) {
      sum[k] = a.over_depth[k] + beta * (b.over_depth[k] - a.over_depth[k]) +
               gamma * (c.over_depth[k] - a.over_depth[k]);
    }
    return sum;
  }

  void meet(int x, int y, const std::array<double, 4>& over_depth, float pitch) {
    Ray& ray = rays_[to_index(y) * to_index(width_) + to_index(x)];
    const auto nearness = static_cast<float>(over_depth[0]);
    if (nearness <= ray.nearness) return;
    const double depth = 1.0 / over_depth[0];
    ray = {nearness, static_cast<float>(over_depth[1] * depth),
           static_cast<float>(over_depth[2] * depth), static_cast<float>(over_depth[3] * depth),
           pitch};
  }

  cv::Rect window_;
  int width_ = 0;
  int height_ = 0;
  std::vector<Ray> rays_;
};

bool is_on(const scene::MipTexture& texture, const Ray& ray) {
  return ray.pitch != kBack && ray.u >= -0.5F && ray.v >= -0.5F &&
         ray.u <= static_cast<float>(texture.width()) - 0.5F &&
         ray.v <= static_cast<float>(texture.height()) - 0.5F;
}

cv::Vec3f colour_of(const scene::MipTexture& texture, const Ray& ray, float ambient) {
  const float cosine = std::max(0.0F, ray.pitch == kBack ? -ray.light : ray.light);
  const float brightness = ambient + (1.0F - ambient) * cosine;
  if (!is_on(texture, ray)) return cv::Vec3f::all(kPaper * brightness);
  const scene::Colour ink = brightness * texture.sample(ray.u, ray.v, ray.pitch);
  return {ink[0], ink[1], ink[2]};
}

}  // namespace

SheetLayer SheetRenderer::render(const std::vector<ScreenVertex>& mesh, int columns) const {
  RayGrid grid(mesh, image_px_);
  const int rows = static_cast<int>(mesh.size()) / columns;
  for (int j = 0; j + 1 < rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      const ScreenVertex* top = mesh.data() + static_cast<std::ptrdiff_t>(j) * columns + i;
      const ScreenVertex* bottom = top + columns;
      grid.draw(top[0], top[1], bottom[1]);
      grid.draw(top[0], bottom[1], bottom[0]);
    }
  }
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  SheetLayer layer{cv::Mat3f(image_px_, cv::Vec3f::all(0.0F)), cv::Mat1f(image_px_, 0.0F),
                   cv::Mat1f(image_px_, 0.0F), cv::Mat2f(image_px_, cv::Vec2f::all(kNone))};
  const cv::Rect& window = grid.window_px();
  for (int y = window.y; y < window.y + window.height; ++y) {
    ask_to_go_on();
    for (int x = window.x; x < window.x + window.width; ++x) {
      for (int k = 0; k < kRays * kRays; ++k) {
        const Ray& ray = grid.at(x, y, k % kRays, k / kRays);
        if (ray.nearness == 0.0F) continue;
        constexpr float kShare = 1.0F / (kRays * kRays);
        layer.coverage(y, x) += kShare;
        layer.colour(y, x) += kShare * colour_of(texture_, ray, ambient_);
      }
      const Ray& middle = grid.at(x, y, kRays / 2, kRays / 2);
      if (middle.nearness == 0.0F) continue;
      layer.depth_m(y, x) = 1.0F / middle.nearness;
      if (is_on(texture_, middle)) layer.template_px(y, x) = {middle.u, middle.v};
    }
  }
  return layer;
}

}  // namespace weft::frex_video
