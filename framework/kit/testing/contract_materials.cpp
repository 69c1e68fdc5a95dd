// SPDX-License-Identifier: Apache-2.0
#include "kit/testing/contract_materials.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

namespace weft::testing {
namespace {

constexpr std::int64_t kDescriptorLength = 128;

/// The map from points of the texture to the image.
struct TrueMap {
  const Template& templ;
  const Camera& camera;
  const DevelopableSheet& sheet;

  Eigen::Vector2d at(double u, double v) const {
    const auto pitch = templ.m_per_px.matrix<1>();
    return project(pinhole(camera), sheet.at(pitch(0) * u, pitch(1) * v));
  }
};

/// The border of the template in the image, a closed polygon in px.
std::vector<Eigen::Vector2d> outline_of(const Template& templ, const TrueMap& map) {
  constexpr int kPieces = 200;  // for each side
  const auto flat_px = templ.flat_px.matrix<2>();
  const Eigen::Vector2d low = flat_px.colwise().minCoeff(), high = flat_px.colwise().maxCoeff();
  const Eigen::Vector2d corners[] = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  std::vector<Eigen::Vector2d> outline;
  for (std::size_t side = 0; side < 4; ++side) {
    const Eigen::Vector2d &from = corners[side], &to = corners[(side + 1) % 4];
    for (int k = 0; k < kPieces; ++k) {
      const Eigen::Vector2d place = from + static_cast<double>(k) / kPieces * (to - from);
      outline.push_back(map.at(place.x(), place.y()));
    }
  }
  return outline;
}

/// Where a polygon crosses the line at this height: its inside is between the first and the second
/// crossing, and so on.
std::vector<double> crossings(const std::vector<Eigen::Vector2d>& polygon, double y) {
  std::vector<double> found;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if ((a.y() > y) == (b.y() > y)) continue;
    found.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

void draw_discs(Array<std::uint8_t>& pixels, Rng& rng) {
  const auto height = static_cast<int>(pixels.dim(0)), width = static_cast<int>(pixels.dim(1));
  for (int disc = 0; disc < 260; ++disc) {
    const auto grey = static_cast<std::uint8_t>(20 + rng.below(216));
    const int radius = 2 + static_cast<int>(rng.below(12));
    const auto x0 = static_cast<int>(rng.below(static_cast<std::uint32_t>(width)));
    const auto y0 = static_cast<int>(rng.below(static_cast<std::uint32_t>(height)));
    for (int y = std::max(0, y0 - radius); y < std::min(height, y0 + radius); ++y) {
      for (int x = std::max(0, x0 - radius); x < std::min(width, x0 + radius); ++x) {
        const bool inside = (x - x0) * (x - x0) + (y - y0) * (y - y0) < radius * radius;
        if (inside) pixels(y, x) = grey;
      }
    }
  }
}

void describe(LabelledMatches& drawn, Rng& rng) {
  Correspondences& matches = drawn.matches;
  const std::int64_t count = matches.count();
  matches.template_keypoint = Array<std::int32_t>({count}, 0);
  matches.image_keypoint = Array<std::int32_t>({count}, 0);
  for (auto* values :
       {&matches.distance, &matches.ratio, &matches.scale_ratio, &matches.angle_difference_rad}) {
    *values = Array<double>({count}, 0.0);
  }
  for (std::int64_t i = 0; i < count; ++i) {
    const bool correct = drawn.correct[to_index(i)] != 0;
    matches.template_keypoint(i) = matches.image_keypoint(i) = static_cast<std::int32_t>(i);
    matches.ratio(i) = correct ? rng.uniform(0.3, 0.8) : rng.uniform(0.6, 0.8);
    matches.distance(i) = 0.5 * matches.ratio(i);
    matches.scale_ratio(i) = std::exp(correct ? 0.1 * rng.normal() : rng.normal());
    matches.angle_difference_rad(i) = correct ? 0.1 * rng.normal() : rng.uniform(-3.1, 3.1);
  }
}

Keypoints make_keypoints(const Points2View& places, Rng rng, double noise, Rng noise_rng) {
  const Eigen::Index count = places.rows();
  Keypoints keypoints;
  keypoints.xy_px = make_array<double>(places);
  keypoints.scale_px = Array<double>({count}, 0.0);
  keypoints.angle_rad = Array<double>({count}, 0.0);
  keypoints.response = Array<double>({count}, 0.0);
  keypoints.octave = Array<std::int32_t>({count}, 0);
  keypoints.metric = "l2";
  keypoints.descriptors = Array<float>({count, kDescriptorLength}, 0.0F);
  for (Eigen::Index i = 0; i < count; ++i) {
    keypoints.scale_px(i) = 3.0;
    keypoints.response(i) = 1.0 + rng.uniform();
    for (Eigen::Index d = 0; d < kDescriptorLength; ++d) {
      const double value = std::floor(rng.uniform(0.0, 120.0) + noise * noise_rng.uniform());
      keypoints.descriptors(i, d) = static_cast<float>(value);
    }
  }
  return keypoints;
}

Keypoints with_bits(Keypoints keypoints) {
  const std::int64_t count = keypoints.count();
  keypoints.metric = "hamming";
  keypoints.binary_descriptors = Array<std::uint8_t>({count, kDescriptorLength / 8}, 0);
  for (std::int64_t i = 0; i < count; ++i) {
    for (std::int64_t d = 0; d + 1 < kDescriptorLength; ++d) {
      const bool bit = keypoints.descriptors(i, d) < keypoints.descriptors(i, d + 1);
      if (bit) keypoints.binary_descriptors(i, d / 8) |= static_cast<std::uint8_t>(1U << (d % 8));
    }
  }
  keypoints.descriptors = {};
  return keypoints;
}

WarpSamples sample_truth(const Template& templ, const Camera& camera,
                         const DevelopableSheet& sheet) {
  const TrueMap map{templ, camera, sheet};
  const auto points = templ.flat_px.matrix<2>();
  const Eigen::Index count = points.rows();
  WarpSamples samples{Array<double>({count, 2}, 0.0), Array<double>({count, 2, 2}, 0.0),
                      Array<double>({count, 2, 3}, 0.0), Array<std::uint8_t>({count}, 0)};
  constexpr double kStep = 1.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double u = points(i, 0), v = points(i, 1);
    const auto f = [&](double du, double dv) { return map.at(u + du * kStep, v + dv * kStep); };
    const Eigen::Vector2d here = f(0, 0);
    const Eigen::Vector2d du = (f(1, 0) - f(-1, 0)) / 2.0, dv = (f(0, 1) - f(0, -1)) / 2.0;
    const Eigen::Vector2d duu = f(1, 0) - 2.0 * here + f(-1, 0);
    const Eigen::Vector2d duv = (f(1, 1) - f(1, -1) - f(-1, 1) + f(-1, -1)) / 4.0;
    const Eigen::Vector2d dvv = f(0, 1) - 2.0 * here + f(0, -1);
    for (int k = 0; k < 2; ++k) {
      samples.xy_px(i, k) = here(k);
      samples.jacobian(i, 2 * k) = du(k);
      samples.jacobian(i, 2 * k + 1) = dv(k);
      samples.hessian(i, 3 * k) = duu(k);
      samples.hessian(i, 3 * k + 1) = duv(k);
      samples.hessian(i, 3 * k + 2) = dvv(k);
    }
    samples.valid(i) = 1;
  }
  return samples;
}

ObjectMask mask_of(const Template& templ, const Camera& camera, const DevelopableSheet& sheet) {
  constexpr int kLines = 8;  // in each row of pixels
  const auto outline = outline_of(templ, {templ, camera, sheet});
  ObjectMask mask;
  mask.foreground = Array<std::uint8_t>({camera.height_px, camera.width_px}, 0);
  mask.known = Array<std::uint8_t>({camera.height_px, camera.width_px}, 1);
  std::vector<double> share(to_index(camera.width_px));
  for (std::int64_t y = 0; y < camera.height_px; ++y) {
    std::fill(share.begin(), share.end(), 0.0);
    for (int line = 0; line < kLines; ++line) {
      const double height = static_cast<double>(y) - 0.5 + (line + 0.5) / kLines;
      const auto ends = crossings(outline, height);
      for (std::size_t k = 0; k + 1 < ends.size(); k += 2) {
        for (std::size_t x = 0; x < share.size(); ++x) {
          const double left = std::max(ends[k], static_cast<double>(x) - 0.5);
          const double right = std::min(ends[k + 1], static_cast<double>(x) + 0.5);
          share[x] += std::max(0.0, right - left) / kLines;
        }
      }
    }
    for (std::size_t x = 0; x < share.size(); ++x) {
      mask.foreground.row(y)[x] = static_cast<std::uint8_t>(std::lround(255.0 * share[x]));
    }
  }
  return mask;
}

void add_maps(const Template& templ, const Camera& camera, const DevelopableSheet& sheet,
              GroundTruth& truth) {
  constexpr int kSteps = 6;
  constexpr double kSmall_px = 1e-6;
  const TrueMap map{templ, camera, sheet};
  const Eigen::Vector2d last(static_cast<double>(templ.texture.dim(1)) - 0.5,
                             static_cast<double>(templ.texture.dim(0)) - 0.5);
  truth.depth_m = Array<float>({camera.height_px, camera.width_px}, 0.0F);
  truth.uv_m =
      Array<float>({camera.height_px, camera.width_px, 2}, std::numeric_limits<float>::quiet_NaN());
  Eigen::Vector2d texel = 0.5 * last;
  for (std::int64_t y = 0; y < camera.height_px; ++y) {
    for (std::int64_t x = 0; x < camera.width_px; ++x) {
      const Eigen::Vector2d pixel(static_cast<double>(x), static_cast<double>(y));
      Eigen::Vector2d off = pixel - map.at(texel.x(), texel.y());
      for (int step = 0; step < kSteps && off.norm() > kSmall_px; ++step) {
        Eigen::Matrix2d slope;
        slope << map.at(texel.x() + 0.5, texel.y()) - map.at(texel.x() - 0.5, texel.y()),
            map.at(texel.x(), texel.y() + 0.5) - map.at(texel.x(), texel.y() - 0.5);
        texel += slope.inverse() * off;
        texel = texel.cwiseMax(-last).cwiseMin(2.0 * last);
        off = pixel - map.at(texel.x(), texel.y());
      }
      const bool is_on = texel.minCoeff() >= -0.5 && (texel.array() <= last.array()).all();
      if (!is_on || !(off.norm() < 1e-3)) continue;
      const double x_m = templ.m_per_px(0) * texel.x(), y_m = templ.m_per_px(1) * texel.y();
      truth.uv_m.row(y)[2 * x] = static_cast<float>(x_m);
      truth.uv_m.row(y)[2 * x + 1] = static_cast<float>(y_m);
      truth.depth_m(y, x) = static_cast<float>(sheet.at(x_m, y_m).z());
    }
  }
}

Shape shape_at(const Points3& vertices_m) {
  Shape shape;
  shape.vertices_m = make_array<double>(vertices_m);
  shape.source = Array<std::uint8_t>({vertices_m.rows()}, 0);
  std::fill_n(shape.source.data(), vertices_m.rows(), std::uint8_t{1});
  shape.confidence = 0.9;
  return shape;
}

Visibility all_visible(std::int64_t count) {
  Visibility visibility{Array<std::uint8_t>({count}, 0),
                        Array<double>({count}, 0.0),
                        Array<std::uint8_t>({count}, 0),
                        {}};
  std::fill_n(visibility.visible.data(), count, std::uint8_t{1});
  std::fill_n(visibility.score.data(), count, 1.0);
  return visibility;
}

GroundTruth truth_of(const Template& templ, const Points3& vertices_m) {
  GroundTruth truth;
  const Eigen::Vector2d pitch = templ.m_per_px.matrix<1>();
  truth.template_xy_m = make_array<double>(Points2(templ.flat_px.matrix<2>() * pitch.asDiagonal()));
  truth.points_m = make_array<double>(vertices_m);
  truth.faces = templ.faces;
  truth.kind = "synthetic";
  return truth;
}

KnownPoints known_corners(const Points3& vertices_m) {
  KnownPoints known{Array<std::int32_t>({2}, 0), Array<double>({2, 3}, 0.0),
                    Array<double>({2}, 0.0)};
  const Eigen::Index last = vertices_m.rows() - 1;
  known.vertex(1) = static_cast<std::int32_t>(last);
  known.points_m.matrix<3>().row(0) = vertices_m.row(0);
  known.points_m.matrix<3>().row(1) = vertices_m.row(last);
  known.radius_m(0) = known.radius_m(1) = 0.005;
  return known;
}

}  // namespace weft::testing
