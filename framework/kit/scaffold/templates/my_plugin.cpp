// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <weft/sdk/template_builder.hpp>

namespace {

constexpr std::uint8_t kPlainGrey = 200;

/// A flat plain disc: a vertex in its middle and others on rings around it.
class MyPluginTemplate final : public weft::TemplateBuilder {
 public:
  explicit MyPluginTemplate(weft::Params& p) {
    p.read("radius_m", radius_m_, "m", {1e-6, 1000}, "radius of the disc");
    p.read("rings", rings_, "", {1, 500}, "number of rings of vertices around the centre");
    p.read("spokes", spokes_, "", {3, 1000}, "number of vertices per ring");
    p.read("texture_px", texture_px_, "px", {8, 4000}, "side of the texture, which is grey");
  }

  weft::Result<weft::Template> build(const weft::Call& /*call*/) override {
    weft::Template templ;
    place_vertices(templ);
    connect(templ);
    paint(templ);
    return templ;
  }

 private:
  /// Index of a vertex: 0 is the middle, rings count from 1.
  std::int32_t vertex(int ring, int spoke) const {
    return ring == 0 ? 0 : 1 + (ring - 1) * spokes_ + spoke % spokes_;
  }

  /// The middle of the disc is the middle of the texture; its edge goes through the outer texels.
  void place_vertices(weft::Template& templ) const {
    const std::int64_t count = 1 + std::int64_t{rings_} * spokes_;
    const double pitch_m = 2.0 * radius_m_ / (texture_px_ - 1);
    templ.vertices_m = weft::Array<double>({count, 3}, 0.0);
    templ.flat_px = weft::Array<double>({count, 2});
    templ.m_per_px = weft::Array<double>({2}, pitch_m);
    for (int ring = 0; ring <= rings_; ++ring) {
      for (int spoke = 0; spoke < (ring == 0 ? 1 : spokes_); ++spoke) {
        const double angle_rad = 2.0 * std::numbers::pi * spoke / spokes_;
        const double from_middle_m = radius_m_ * ring / rings_;
        const std::int32_t v = vertex(ring, spoke);
        templ.vertices_m(v, 0) = radius_m_ + from_middle_m * std::cos(angle_rad);
        templ.vertices_m(v, 1) = radius_m_ + from_middle_m * std::sin(angle_rad);
        for (int k = 0; k < 2; ++k) templ.flat_px(v, k) = templ.vertices_m(v, k) / pitch_m;
      }
    }
  }

  /// Faces are counter-clockwise as the camera sees them, whose y points down.
  void connect(weft::Template& templ) const {
    const std::int64_t count = std::int64_t{spokes_} * (2 * rings_ - 1);
    templ.faces = weft::Array<std::int32_t>({count, 3});
    std::int64_t f = 0;
    const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
      templ.faces(f, 0) = a;
      templ.faces(f, 1) = b;
      templ.faces(f, 2) = c;
      ++f;
    };
    for (int spoke = 0; spoke < spokes_; ++spoke) {
      add(0, vertex(1, spoke + 1), vertex(1, spoke));
      for (int ring = 1; ring < rings_; ++ring) {
        const std::int32_t inner = vertex(ring, spoke), outer_next = vertex(ring + 1, spoke + 1);
        add(inner, outer_next, vertex(ring + 1, spoke));
        add(inner, vertex(ring, spoke + 1), outer_next);
      }
    }
  }

  /// A plain texture with the disc as the object.
  void paint(weft::Template& templ) const {
    templ.texture = weft::Array<std::uint8_t>({texture_px_, texture_px_}, kPlainGrey);
    templ.mask = weft::Array<std::uint8_t>({texture_px_, texture_px_}, 0);
    const double middle_px = 0.5 * (texture_px_ - 1);
    for (int y = 0; y < texture_px_; ++y) {
      for (int x = 0; x < texture_px_; ++x) {
        if (std::hypot(x - middle_px, y - middle_px) <= middle_px) templ.mask(y, x) = 1;
      }
    }
  }

  double radius_m_ = 0.08;
  int rings_ = 4;
  int spokes_ = 16;
  int texture_px_ = 320;
};

}  // namespace

WEFT_PLUGIN(MyPluginTemplate, "templates/my_plugin", "1.0.0", "Makes a flat plain disc.")
