// SPDX-License-Identifier: Apache-2.0
#include <weft/sdk/template_builder.hpp>

namespace {

/// Four vertices in two faces, over a texture of 8 x 6 px.
struct Small final : weft::TemplateBuilder {
  double pitch_m = 0.5;

  explicit Small(weft::Params& p) {
    p.read("pitch_m", pitch_m, "m", {0.0625, 4}, "between neighbours");
  }

  weft::Result<weft::Template> build(const weft::Call&) override {
    weft::Template templ;
    templ.vertices_m = weft::Array<double>({4, 3}, 0.0);
    templ.flat_px = weft::Array<double>({4, 2});
    for (std::int64_t i = 0; i < 4; ++i) {
      const double u = static_cast<double>(i % 2), v = static_cast<double>(i / 2);
      templ.vertices_m(i, 0) = pitch_m * u;
      templ.vertices_m(i, 1) = pitch_m * v;
      templ.flat_px(i, 0) = 4.0 * u + 1.0;
      templ.flat_px(i, 1) = 4.0 * v + 1.0;
    }
    templ.faces = weft::Array<std::int32_t>({2, 3});
    const std::int32_t corners[] = {0, 1, 2, 1, 3, 2};
    for (std::int64_t i = 0; i < 6; ++i) templ.faces.data()[i] = corners[i];
    templ.m_per_px = weft::Array<double>({2}, pitch_m / 4.0);
    templ.texture = weft::Array<std::uint8_t>({6, 8}, 100);
    templ.mask = weft::Array<std::uint8_t>({6, 8}, 1);
    return templ;
  }
};

}  // namespace

WEFT_PLUGIN(Small, "templates/kept.small", "1.0.0", "A square of two triangles.")
