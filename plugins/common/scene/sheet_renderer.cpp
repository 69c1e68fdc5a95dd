// SPDX-License-Identifier: Apache-2.0
#include "common/scene/sheet_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::scene {
namespace {

using Reach = LitMesh::Reach;

constexpr double kNearest_m = 0.01;
constexpr std::int32_t kSheet = 0;
constexpr int kSide = 3;  // samples of a pixel along x and y

/// Centres of the samples of a pixel.
constexpr auto centres_of_samples() {
  std::array<std::array<double, 2>, std::size_t{kSide} * kSide> centres{};
  for (std::size_t k = 0; k < centres.size(); ++k) {
    const std::size_t row = k / kSide;
    centres[k] = {(static_cast<double>(k % kSide) + 0.5) / kSide - 0.5,
                  (static_cast<double>(row) + 0.5) / kSide - 0.5};
  }
  return centres;
}

constexpr auto kSamples = centres_of_samples();

constexpr int kPadded = 12;  // more than the samples, and a multiple of a vector's length

/// The coordinates of the samples along one axis, filled up with zeros.
MipTexture::Floats<kPadded> padded_samples(std::size_t axis) {
  MipTexture::Floats<kPadded> padded = MipTexture::Floats<kPadded>::Zero();
  for (std::size_t k = 0; k < kSamples.size(); ++k) {
    padded[static_cast<int>(k)] = static_cast<float>(kSamples[k][axis]);
  }
  return padded;
}

const MipTexture::Floats<kPadded> kSamplesX = padded_samples(0), kSamplesY = padded_samples(1);

double longest_side(const Points2& uv_px, const Faces& faces) {
  double longest = 0.0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto side = uv_px.row(faces(f, k)) - uv_px.row(faces(f, (k + 1) % 3));
      longest = std::max(longest, side.norm());
    }
  }
  return longest;
}

}  // namespace

Result<SheetRenderer> SheetRenderer::create(const Camera& camera, MipTexture print,
                                            const Points2& uv_px, const Faces& faces,
                                            Picture background, const Paper& paper) {
  auto caster = RayCaster::create();
  if (!caster) return caster.error();
  return SheetRenderer(camera, std::move(print), uv_px, faces, std::move(background), paper,
                       *std::move(caster));
}

SheetRenderer::SheetRenderer(const Camera& camera, MipTexture print, const Points2& uv_px,
                             const Faces& faces, Picture background, const Paper& paper,
                             RayCaster caster)
    : pinhole_{camera.fx, camera.fy, camera.cx, camera.cy},
      width_(static_cast<int>(camera.width_px)),
      height_(static_cast<int>(camera.height_px)),
      print_(std::move(print)),
      uv_px_(uv_px),
      faces_(faces),
      cell_px_(longest_side(uv_px, faces)),
      background_(std::move(background)),
      paper_(paper),
      caster_(std::move(caster)) {}

View SheetRenderer::render_nothing() const {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  View view{background_, {}, {}, {}, {}, {}};
  view.coverage = Array<float>({height_, width_}, 0.0F);
  view.hits.resize(background_.pixels.size());
  view.depth_m = Array<float>({height_, width_}, 0.0F);
  view.uv_px = Array<float>({height_, width_, 2}, kNone);
  view.is_visible.resize(to_index(uv_px_.rows()));
  return view;
}

View SheetRenderer::render(const Points3View& vertices_m, const Light& light,
                           std::optional<Solid> solid, Scope scope) {
  Scene scene{LitMesh(pinhole_, {vertices_m, faces_}, light)};
  std::vector<const TriangleMesh*> meshes{&scene.sheet.mesh()};
  if (solid) {
    scene.solid.emplace(pinhole_, std::move(solid->mesh), light);
    scene.solid_colours = std::move(solid->colours);
    meshes.push_back(&scene.solid->mesh());
  }
  caster_.set_meshes(meshes);
  View view = render_nothing();
  const Window window = covered(scene);
  trace_centres(window, view);
  fill_maps(scene, window, view);
  draw(scene, window, view);
  if (paper_.margin) forget_margins(window, view);
  if (scope == Scope::pixels_and_vertices) find_visible(scene, view);
  return view;
}

SheetRenderer::Window SheetRenderer::covered(const Scene& scene) const {
  double x0 = width_, y0 = height_, x1 = -1.0, y1 = -1.0;
  for (const LitMesh* each : {&scene.sheet, scene.solid ? &*scene.solid : nullptr}) {
    if (each == nullptr) continue;
    const Points3& vertices_m = each->mesh().vertices_m;
    if (vertices_m.col(2).minCoeff() < kNearest_m) return {0, 0, width_, height_};
    for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
      const Eigen::Vector2d pixel = project(pinhole_, vertices_m.row(v).transpose());
      x0 = std::min(x0, pixel.x());
      y0 = std::min(y0, pixel.y());
      x1 = std::max(x1, pixel.x());
      y1 = std::max(y1, pixel.y());
    }
  }
  // One pixel more on each side, which may be covered in part.
  const auto within = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  const Window window{within(std::floor(x0) - 1.0, width_), within(std::floor(y0) - 1.0, height_),
                      within(std::ceil(x1) + 1.0, width_), within(std::ceil(y1) + 1.0, height_)};
  return window.x0 < window.x1 && window.y0 < window.y1 ? window : Window{0, 0, 0, 0};
}

void SheetRenderer::trace_centres(const Window& window, View& view) const {
  constexpr int kTile = 8;  // rays of a tile stay together in the caster
  std::vector<std::size_t> pixels;
  std::vector<Eigen::Vector3f> rays;
  for (int top = window.y0; top < window.y1; top += kTile) {
    pixels.clear();
    rays.clear();
    for (int left = window.x0; left < window.x1; left += kTile) {
      for (int y = top; y < std::min(top + kTile, window.y1); ++y) {
        ask_to_go_on();
        for (int x = left; x < std::min(left + kTile, window.x1); ++x) {
          pixels.push_back(index(x, y));
          rays.push_back(ray(x, y));
        }
      }
    }
    const std::vector<RayHit> hits = caster_.trace(rays);
    for (std::size_t k = 0; k < hits.size(); ++k) view.hits[pixels[k]] = hits[k];
  }
}

void SheetRenderer::fill_maps(Scene& scene, const Window& window, View& view) const {
  scene.light.resize(view.hits.size());
  for (int y = window.y0; y < window.y1; ++y) {
    ask_to_go_on();
    for (int x = window.x0; x < window.x1; ++x) {
      const RayHit& hit = view.hits[index(x, y)];
      if (hit.mesh < 0) continue;
      const LitMesh& mesh = hit.mesh == kSheet ? scene.sheet : *scene.solid;
      const FacePoint point = mesh.at(hit.face, x, y, Reach::of_a_hit);
      view.depth_m(y, x) = static_cast<float>(point.depth_m);
      scene.light[index(x, y)] = mesh.brightness(point);
      if (hit.mesh != kSheet || !mesh.is_front(hit.face)) continue;
      const Eigen::RowVector2d uv = mesh.interpolated(uv_px_, point);
      view.uv_px.row(y)[2 * x] = static_cast<float>(uv.x());
      view.uv_px.row(y)[2 * x + 1] = static_cast<float>(uv.y());
    }
  }
}

void SheetRenderer::draw(const Scene& scene, const Window& window, View& view) const {
  const std::vector<std::uint8_t> is_edge = find_edges(scene, window, view);
  std::vector<std::array<int, 2>> edges;
  std::vector<Eigen::Vector3f> rays;
  for (int y = window.y0; y < window.y1; ++y) {
    ask_to_go_on();
    for (int x = window.x0; x < window.x1; ++x) {
      if (is_edge[index(x, y)] != 0) {
        edges.push_back({x, y});
        for (const auto& [dx, dy] : kSamples) rays.push_back(ray(x + dx, y + dy));
      } else if (view.hits[index(x, y)].mesh >= 0) {
        view.image.pixels[index(x, y)] = inner_colour(scene, view, x, y);
        view.coverage(y, x) = 1.0F;
      }
    }
  }
  const std::vector<RayHit> hits = caster_.trace(rays);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const auto [x, y] = edges[k];
    const std::span<const RayHit> own(hits.data() + kSamples.size() * k, kSamples.size());
    draw_edge(scene, own, x, y, view);
  }
}

std::vector<std::uint8_t> SheetRenderer::find_edges(const Scene& scene, const Window& window,
                                                    const View& view) const {
  std::vector<std::uint8_t> is_edge(view.hits.size());
  const Eigen::Map<const Eigen::Matrix2Xf> uv(view.uv_px.data(), 2,
                                              static_cast<Eigen::Index>(view.hits.size()));
  const auto limit = static_cast<float>(2.0 * cell_px_);
  const auto differ = [&](std::size_t a, std::size_t b) {
    const RayHit &here = view.hits[a], &there = view.hits[b];
    if (here.mesh != there.mesh) return true;
    if (here.mesh != kSheet || here.face == there.face) return false;
    const bool is_front = scene.sheet.is_front(here.face);
    if (scene.sheet.is_front(there.face) != is_front) return true;
    const auto step = uv.col(static_cast<Eigen::Index>(a)) - uv.col(static_cast<Eigen::Index>(b));
    return is_front && step.squaredNorm() > limit * limit;
  };
  const auto compare = [&](int x, int y, int i, int j) {
    if (i < window.x0 || i >= window.x1 || j >= window.y1) return;
    if (differ(index(x, y), index(i, j))) is_edge[index(x, y)] = is_edge[index(i, j)] = 1;
  };
  for (int y = window.y0; y < window.y1; ++y) {
    ask_to_go_on();
    for (int x = window.x0; x < window.x1; ++x) {
      compare(x, y, x + 1, y);
      for (int i = x - 1; i <= x + 1; ++i) compare(x, y, i, y + 1);
    }
  }
  return is_edge;
}

bool SheetRenderer::is_on_print(float u, float v) const {
  return u >= -0.5F && v >= -0.5F && u <= static_cast<float>(print_.width()) - 0.5F &&
         v <= static_cast<float>(print_.height()) - 0.5F;
}

inline Colour SheetRenderer::print_colour(float u, float v,
                                          const MipTexture::Sampler& print) const {
  if (paper_.margin && !is_on_print(u, v)) return Colour::Constant(*paper_.margin);
  return print.at(u, v);
}

void SheetRenderer::forget_margins(const Window& window, View& view) const {
  for (int y = window.y0; y < window.y1; ++y) {
    for (int x = window.x0; x < window.x1; ++x) {
      Eigen::Map<Eigen::Array2f> uv(view.uv_px.row(y) + std::ptrdiff_t{2} * x);
      if (!is_on_print(uv[0], uv[1])) uv.setConstant(std::numeric_limits<float>::quiet_NaN());
    }
  }
}

/// Casts a separate ray, which samples a part of the pixel.
Colour SheetRenderer::sheet_colour(const LitMesh& sheet, std::int32_t face, double x,
                                   double y) const {
  const FacePoint point = sheet.at(face, x, y, Reach::of_a_hit);
  const float light = sheet.brightness(point);
  if (!sheet.is_front(face)) return Colour::Constant(light * paper_.back);
  const auto uv = [&](double dx, double dy) {
    return sheet.interpolated(uv_px_, sheet.at(face, x + dx, y + dy, Reach::of_a_neighbour));
  };
  constexpr double kHalf = 0.5 / kSide;
  const double along = (uv(kHalf, 0.0) - uv(-kHalf, 0.0)).squaredNorm();
  const double across = (uv(0.0, kHalf) - uv(0.0, -kHalf)).squaredNorm();
  const Eigen::Array2f here = sheet.interpolated(uv_px_, point).cast<float>().transpose().array();
  const auto texels = static_cast<float>(std::sqrt(0.5 * (along + across)));
  return light * print_colour(here[0], here[1], print_.sampler(texels));
}

Colour SheetRenderer::solid_colour(const Scene& scene, std::int32_t face, double x,
                                   double y) const {
  const FacePoint point = scene.solid->at(face, x, y, Reach::of_a_hit);
  Colour colour = Colour::Zero();
  for (int k = 0; k < 3; ++k) {
    const auto vertex = to_index(scene.solid->mesh().faces(face, k));
    colour += static_cast<float>(point.weights[k]) * scene.solid_colours[vertex];
  }
  return scene.solid->brightness(point) * colour;
}

/// Samples lie where the map of template points, linear around the pixel, puts them.
Colour SheetRenderer::inner_colour(const Scene& scene, const View& view, int x, int y) const {
  const RayHit& hit = view.hits[index(x, y)];
  if (hit.mesh != kSheet) return solid_colour(scene, hit.face, x, y);
  const float light = scene.light[index(x, y)];
  if (!scene.sheet.is_front(hit.face)) return Colour::Constant(light * paper_.back);
  const auto uv = [&](int i, int j) { return view.uv_px.row(j) + std::ptrdiff_t{2} * i; };
  const int left = std::max(x - 1, 0), right = std::min(x + 1, width_ - 1);
  const int above = std::max(y - 1, 0), below = std::min(y + 1, height_ - 1);
  const auto slope = [](const float* from, const float* to, int steps, int k) {
    return (to[k] - from[k]) / static_cast<float>(steps);
  };
  const float u_along = slope(uv(left, y), uv(right, y), right - left, 0);
  const float v_along = slope(uv(left, y), uv(right, y), right - left, 1);
  const float u_across = slope(uv(x, above), uv(x, below), below - above, 0);
  const float v_across = slope(uv(x, above), uv(x, below), below - above, 1);
  const float squares =
      (u_along * u_along + v_along * v_along) + (u_across * u_across + v_across * v_across);
  const MipTexture::Sampler print = print_.sampler(std::sqrt(0.5F * squares) / kSide);
  const float u = uv(x, y)[0], v = uv(x, y)[1];
  if (print_.is_grey() && !paper_.margin) {
    const auto greys = print.greys_at<kPadded>(u + kSamplesX * u_along + kSamplesY * u_across,
                                               v + kSamplesX * v_along + kSamplesY * v_across);
    float sum = 0.0F;
    for (std::size_t k = 0; k < kSamples.size(); ++k) sum += greys[static_cast<int>(k)];
    return Colour::Constant(light * sum / static_cast<float>(kSamples.size()));
  }
  Colour sum = Colour::Zero();
  for (const auto& [dx, dy] : kSamples) {
    sum += print_colour(u + static_cast<float>(dx) * u_along + static_cast<float>(dy) * u_across,
                        v + static_cast<float>(dx) * v_along + static_cast<float>(dy) * v_across,
                        print);
  }
  return light * sum / static_cast<float>(kSamples.size());
}

void SheetRenderer::draw_edge(const Scene& scene, std::span<const RayHit> hits, int x, int y,
                              View& view) const {
  Colour sum = Colour::Zero();
  int on_background = 0;
  for (std::size_t k = 0; k < kSamples.size(); ++k) {
    const double at_x = x + kSamples[k][0], at_y = y + kSamples[k][1];
    const std::int32_t face = hits[k].face;
    if (hits[k].mesh < 0) {
      ++on_background;
    } else if (hits[k].mesh == kSheet) {
      sum += sheet_colour(scene.sheet, face, at_x, at_y);
    } else {
      sum += solid_colour(scene, face, at_x, at_y);
    }
  }
  constexpr float kShare = 1.0F / kSamples.size();
  const float beside = kShare * static_cast<float>(on_background);
  Colour& pixel = view.image.pixels[index(x, y)];
  pixel = kShare * sum + beside * pixel;
  view.coverage(y, x) = 1.0F - beside;
}

void SheetRenderer::find_visible(const Scene& scene, View& view) const {
  constexpr double kSlackInCells = 0.05;
  const Points3& vertices_m = scene.sheet.mesh().vertices_m;
  const double cell_m = (vertices_m.row(faces_(0, 1)) - vertices_m.row(faces_(0, 0))).norm();
  const std::vector<std::uint8_t> hidden = caster_.are_hidden(vertices_m, kSlackInCells * cell_m);
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    if (!scene.sheet.is_front(static_cast<std::int32_t>(f))) continue;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d point = vertices_m.row(faces_(f, k)).transpose();
      const Eigen::Vector2d pixel = project(pinhole_, point);
      const bool in_image = point.z() > kNearest_m && pixel.x() >= -0.5 && pixel.y() >= -0.5 &&
                            pixel.x() <= width_ - 0.5 && pixel.y() <= height_ - 0.5;
      const auto v = to_index(faces_(f, k));
      view.is_visible[v] = in_image && hidden[v] == 0 ? 1 : 0;
    }
  }
}

Eigen::Vector3f SheetRenderer::ray(double x, double y) const {
  return {static_cast<float>((x - pinhole_.cx) / pinhole_.fx),
          static_cast<float>((y - pinhole_.cy) / pinhole_.fy), 1.0F};
}

std::size_t SheetRenderer::index(int x, int y) const {
  return to_index(y) * to_index(width_) + to_index(x);
}

}  // namespace weft::scene
