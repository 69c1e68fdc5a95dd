// SPDX-License-Identifier: Apache-2.0
#include "refinement.hpp"

#include <cmath>

namespace weft::sift_fast {
namespace {

constexpr int kMostSteps = 5;

/// Derivatives of the difference in x, y and layer, grey levels 0 to 1.
struct Taylor {
  float value, dx, dy, ds, dxx, dyy, dss, dxy, dxs, dys;
};

/// A step in x, y and layer.
struct Step {
  float x, y, s;
  bool within(float horizontal, float vertical, float across) const {
    return std::abs(x) < horizontal && std::abs(y) < vertical && std::abs(s) < across;
  }
};

Taylor expand(const Octave& octave, int x, int y, int layer) {
  float d[3][3][3];
  for (int l = 0; l < 3; ++l) {
    const Plane& below = octave.layers[static_cast<std::size_t>(layer + l - 1)];
    const Plane& above = octave.layers[static_cast<std::size_t>(layer + l)];
    for (int v = 0; v < 3; ++v) {
      const std::int16_t* from = below.row(y + v - 1) + x - 1;
      const std::int16_t* to = above.row(y + v - 1) + x - 1;
      for (int u = 0; u < 3; ++u) {
        d[l][v][u] = static_cast<float>(to[u] - from[u]) * (1.0F / (255.0F * kUnit));
      }
    }
  }
  Taylor t{};
  t.value = d[1][1][1];
  t.dx = 0.5F * (d[1][1][2] - d[1][1][0]);
  t.dy = 0.5F * (d[1][2][1] - d[1][0][1]);
  t.ds = 0.5F * (d[2][1][1] - d[0][1][1]);
  t.dxx = d[1][1][2] + d[1][1][0] - 2.0F * t.value;
  t.dyy = d[1][2][1] + d[1][0][1] - 2.0F * t.value;
  t.dss = d[2][1][1] + d[0][1][1] - 2.0F * t.value;
  t.dxy = 0.25F * (d[1][2][2] - d[1][2][0] - d[1][0][2] + d[1][0][0]);
  t.dxs = 0.25F * (d[2][1][2] - d[2][1][0] - d[0][1][2] + d[0][1][0]);
  t.dys = 0.25F * (d[2][2][1] - d[2][0][1] - d[0][2][1] + d[0][0][1]);
  return t;
}

/// -H^-1 g by Cramer's rule; zero where H is singular.
Step stationary(const Taylor& t) {
  const float cxx = t.dyy * t.dss - t.dys * t.dys;
  const float cxy = t.dxs * t.dys - t.dxy * t.dss;
  const float cxs = t.dxy * t.dys - t.dyy * t.dxs;
  const float determinant = t.dxx * cxx + t.dxy * cxy + t.dxs * cxs;
  if (determinant == 0.0F) return {0.0F, 0.0F, 0.0F};
  const float cyy = t.dxx * t.dss - t.dxs * t.dxs;
  const float cys = t.dxy * t.dxs - t.dxx * t.dys;
  const float css = t.dxx * t.dyy - t.dxy * t.dxy;
  return {-(cxx * t.dx + cxy * t.dy + cxs * t.ds) / determinant,
          -(cxy * t.dx + cyy * t.dy + cys * t.ds) / determinant,
          -(cxs * t.dx + cys * t.dy + css * t.ds) / determinant};
}

bool is_on_edge(const Taylor& t, float edge) {
  const float trace = t.dxx + t.dyy, determinant = t.dxx * t.dyy - t.dxy * t.dxy;
  return determinant <= 0.0F || trace * trace * edge >= (edge + 1.0F) * (edge + 1.0F) * determinant;
}

}  // namespace

Refinement::Refinement(const Settings& settings)
    : layers_(settings.octave_layers),
      weakest_(kUnit * static_cast<int>(0.5 * settings.contrast_threshold / settings.octave_layers *
                                        255.0)),
      contrast_(static_cast<float>(settings.contrast_threshold / settings.octave_layers)),
      edge_(static_cast<float>(settings.edge_threshold)),
      sigma_(settings.sigma_px) {}

std::optional<Spot> Refinement::refine(const Octave& octave, int x, int y, int layer) const {
  const int width = octave.width(), height = octave.height();
  for (int n = 0; n < kMostSteps; ++n) {
    const Taylor t = expand(octave, x, y, layer);
    const Step step = stationary(t);
    if (step.within(0.5F, 0.5F, 0.5F)) {
      const float response =
          std::abs(t.value + 0.5F * (t.dx * step.x + t.dy * step.y + t.ds * step.s));
      if (response < contrast_ || is_on_edge(t, edge_)) return std::nullopt;
      Spot spot;
      spot.x = static_cast<float>(x) + step.x;
      spot.y = static_cast<float>(y) + step.y;
      const double layers_up = static_cast<double>(layer) + static_cast<double>(step.s);
      spot.scale = static_cast<float>(sigma_ * std::exp2(layers_up / layers_));
      spot.response = response;
      spot.layer = layer;
      return spot;
    }
    if (!step.within(static_cast<float>(width), static_cast<float>(height),
                     static_cast<float>(layers_ + 1))) {
      return std::nullopt;
    }
    x += static_cast<int>(std::lrint(step.x));
    y += static_cast<int>(std::lrint(step.y));
    layer += static_cast<int>(std::lrint(step.s));
    if (layer < 1 || layer > layers_ || x < Pyramid::kBorder || x >= width - Pyramid::kBorder ||
        y < Pyramid::kBorder || y >= height - Pyramid::kBorder) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace weft::sift_fast
