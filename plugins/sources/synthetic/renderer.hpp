// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>
#include <weft/data/array.hpp>
#include <weft/data/camera.hpp>
#include <weft/generators/developable.hpp>

namespace weft::synthetic {

/// A grey picture on the sheet with the halved copies that minification needs.
class Texture {
 public:
  Texture() = default;
  /// `pixels` [height * width], row by row.
  Texture(int width, int height, std::vector<float> pixels);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  int level_count() const { return static_cast<int>(levels_.size()); }

  /// Bilinear grey level at (u,v) px of the full picture; `level` is halved that many times.
  float sample(int level, float u, float v) const;

 private:
  struct Level {
    int width, height;
    std::vector<float> pixels;
  };
  static Level halved(const Level& level);

  std::vector<Level> levels_;
};

/// Texel pitch in m along u and v: the texel with centre (u,v) px lies at (x,y) = pitch * (u,v).
using Pitch = std::array<double, 2>;

/// Draws a textured sheet over a background, as a pinhole camera with square, fully sensitive
/// pixels would see it: pixel (i,j) is the mean over [i-1/2,i+1/2] x [j-1/2,j+1/2], by 3 x 3 rays
/// that meet a fine mesh of the sheet. The mesh is projected exactly, texture coordinates are
/// interpolated with perspective, and a depth buffer hides what lies behind. The back is blank
/// paper.
class Renderer {
 public:
  static constexpr int kRays = 3;  ///< along x and along y of a pixel

  /// `background` [height * width] grey levels.
  Renderer(const Camera& camera, Texture texture, Pitch pitch_m, std::vector<float> background);

  /// The grey levels [height * width] without noise, valid until the next call. Parts of the sheet
  /// closer to the camera than 1 cm are not drawn.
  const std::vector<float>& render(const DevelopableSheet& sheet);
  /// The background alone.
  const std::vector<float>& background() const { return background_; }

 private:
  /// A vertex of the mesh: place in units of rays, and what is linear in it once divided by depth.
  struct Vertex {
    double x, y;
    std::array<float, 4> over_depth;  ///< 1/z, u/z, v/z, brightness/z
    bool in_front;
  };
  /// The region of rays that the sheet covers.
  struct Window {
    int x0, y0, x1, y1;
  };

  void project_mesh(const DevelopableSheet& sheet);
  Window covered() const;
  /// The picture with about one texel a ray.
  int level_for(double texels_per_ray) const;
  void draw_triangle(const Vertex& a, const Vertex& b, const Vertex& c);
  void draw_row(int y, int x0, int x1, const std::array<float, 4>& start,
                const std::array<float, 4>& step, int level);
  void resolve();

  Camera camera_;
  Texture texture_;
  Pitch pitch_m_;
  std::vector<float> background_;
  int columns_ = 0;
  int rows_ = 0;
  double texels_per_cell_ = 0.0;
  Window window_{};
  std::vector<Vertex> vertices_;
  std::vector<float> nearness_;  ///< 1/z of the nearest surface on each ray of the window
  std::vector<float> grey_;      ///< what each ray sees
  std::vector<float> image_;
};

}  // namespace weft::synthetic
