// SPDX-License-Identifier: Apache-2.0
#include "common/view/predicted_view.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>

#include "common/view/blur.hpp"

namespace weft::view {
namespace {

constexpr double kNearest_m = 0.01;
constexpr Lanes kOffsets{0.0F, 1.0F, 2.0F, 3.0F};
constexpr float kNothing = -1.0F;  // a grey level that no texture has
double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Bilinear grey levels at four places, at the border those of the border; the image has at least
/// two pixels along each side.
Lanes sample_texture(const Picture& picture, Lanes u, Lanes v) {
  const Lanes right = Lanes{} + (static_cast<float>(picture.width) - 1.001F);
  const Lanes bottom = Lanes{} + (static_cast<float>(picture.height) - 1.001F);
  u = u > 0.0F ? u : Lanes{};
  v = v > 0.0F ? v : Lanes{};
  u = u < right ? u : right;
  v = v < bottom ? v : bottom;
  const WholeLanes i = __builtin_convertvector(u, WholeLanes);
  const WholeLanes j = __builtin_convertvector(v, WholeLanes);
  const Lanes s = u - __builtin_convertvector(i, Lanes), t = v - __builtin_convertvector(j, Lanes);
  // Neighbours are loaded together: loads are what takes the time here.
  static_assert(kLanes == 4);
  typedef float Pair
      __attribute__((vector_size(2 * sizeof(float)), aligned(alignof(float)), may_alias));
  const auto pairs_of = [](const float* const* from, int first, std::ptrdiff_t off) {
    const Pair one = *reinterpret_cast<const Pair*>(from[first] + off);
    const Pair two = *reinterpret_cast<const Pair*>(from[first + 1] + off);
    return __builtin_shufflevector(one, two, 0, 1, 2, 3);
  };
  const float* above[kLanes];
  for (int k = 0; k < kLanes; ++k) above[k] = picture.row(j[k]) + i[k];
  const std::ptrdiff_t below = picture.width;
  const Lanes upper_01 = pairs_of(above, 0, 0), upper_23 = pairs_of(above, 2, 0);
  const Lanes lower_01 = pairs_of(above, 0, below), lower_23 = pairs_of(above, 2, below);
  const Lanes a = __builtin_shufflevector(upper_01, upper_23, 0, 2, 4, 6);
  const Lanes b = __builtin_shufflevector(upper_01, upper_23, 1, 3, 5, 7);
  const Lanes c = __builtin_shufflevector(lower_01, lower_23, 0, 2, 4, 6);
  const Lanes d = __builtin_shufflevector(lower_01, lower_23, 1, 3, 5, 7);
  const Lanes upper = a + s * (b - a), lower = c + s * (d - c);
  return upper + t * (lower - upper);
}

void halve_view(const ViewLevel& from, ViewLevel& to) {
  halve(from.grey, to.grey);
  to.x0 = from.x0 / 2;
  to.y0 = from.y0 / 2;
  to.drawn.resize(to_index(to.grey.width * to.grey.height));
  for (int y = 0; y < to.grey.height; ++y) {
    const std::uint8_t* __restrict above = from.drawn_row(2 * y);
    const std::uint8_t* __restrict below = from.drawn_row(2 * y + 1);
    std::uint8_t* __restrict out = to.drawn.data() + to_index(y) * to_index(to.grey.width);
    for (int x = 0; x < to.grey.width; ++x) {
      out[x] = static_cast<std::uint8_t>(above[2 * x] & above[2 * x + 1] & below[2 * x] &
                                         below[2 * x + 1]);
    }
  }
}

}  // namespace

void PredictedView::load(const Template& templ) {
  flat_px_ = templ.flat_px.matrix<2>();
  faces_ = templ.faces.matrix<3>();
  textures_.resize(1);
  read_grey(templ.texture, textures_.front());
  while (textures_.back().width >= 4 && textures_.back().height >= 4) {
    Picture half;
    halve(textures_.back(), half);
    textures_.push_back(std::move(half));
  }
  mask_ = {};
  bool has_holes = false;
  for (std::int64_t y = 0; y < templ.mask.dim(0); ++y) {
    worked(templ.mask.dim(1) / 16);
    has_holes = has_holes || std::any_of(templ.mask.row(y), templ.mask.row(y) + templ.mask.dim(1),
                                         [](std::uint8_t m) { return m == 0; });
  }
  if (!has_holes) return;
  mask_ = Array<std::uint8_t>({templ.mask.dim(0), templ.mask.dim(1)});
  for (std::int64_t y = 0; y < mask_.dim(0); ++y) {
    std::copy_n(templ.mask.row(y), mask_.dim(1), mask_.row(y));
  }
}

bool PredictedView::draw(const Camera& camera, const Points3View& vertices_m) {
  project(camera, vertices_m);
  if (!open_window(camera)) return false;
  for (std::int32_t f = 0; f < faces_.rows(); ++f) draw_face(f);
  ViewLevel& view = levels_[to_index(finest_)];
  view.drawn.resize(to_index(view.grey.width * view.grey.height));
  bool is_any_drawn = false;
  for (std::size_t i = 0; i < view.drawn.size(); ++i) {
    view.drawn[i] = view.grey.values[i] >= 0.0F ? 1 : 0;
    is_any_drawn = is_any_drawn | (view.drawn[i] != 0);
  }
  if (!is_any_drawn) return false;
  halve_from_finest();
  return true;
}

void PredictedView::halve_from_finest() {
  for (std::size_t k = to_index(finest_) + 1; k < levels_.size(); ++k) {
    halve_view(levels_[k - 1], levels_[k]);
  }
}

void PredictedView::blur(double sigma_px) {
  blur_drawn(sigma_px / static_cast<double>(1 << finest_), levels_[to_index(finest_)]);
  halve_from_finest();
}

void PredictedView::project(const Camera& camera, const Points3View& vertices_m) {
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  vertices_.resize(to_index(vertices_m.rows()));
  for (Eigen::Index i = 0; i < vertices_m.rows(); ++i) {
    const Eigen::Vector3d place_m = vertices_m.row(i);
    const Eigen::Vector2d pixel = weft::project(pinhole, place_m);
    vertices_[to_index(i)] = {pixel.x(), pixel.y(), 1.0 / place_m.z(),
                              pixel.allFinite() && place_m.z() > kNearest_m};
  }
}

/// The part of the image that the shape may cover, empty of everything.
bool PredictedView::open_window(const Camera& camera) {
  const double scale = 1 << finest_;
  const auto width = static_cast<int>(camera.width_px >> finest_);
  const auto height = static_cast<int>(camera.height_px >> finest_);
  double low_x = width, low_y = height, high_x = -1.0, high_y = -1.0;
  for (const Vertex& vertex : vertices_) {
    if (!vertex.is_in_front) continue;
    low_x = std::min(low_x, vertex.x / scale - 1.0);
    low_y = std::min(low_y, vertex.y / scale - 1.0);
    high_x = std::max(high_x, vertex.x / scale + 1.0);
    high_y = std::max(high_y, vertex.y / scale + 1.0);
  }
  // Levels of a window that begins at such a pixel line up.
  const int step = 1 << (kLevels - 1 - finest_);
  const auto begin = [&](double low) { return static_cast<int>(std::max(low, 0.0)) / step * step; };
  const auto end = [](double high, int size) {
    return static_cast<int>(std::min(high + 1.0, static_cast<double>(size)));
  };
  ViewLevel& view = levels_[to_index(finest_)];
  view.x0 = begin(low_x);
  view.y0 = begin(low_y);
  const int columns = end(high_x, width) - view.x0, rows = end(high_y, height) - view.y0;
  if (columns < step || rows < step) return false;
  view.grey.resize(columns, rows);
  std::fill(view.grey.values.begin(), view.grey.values.end(), kNothing);
  nearness_.assign(view.grey.values.size(), 0.0F);
  if (with_faces_) view.face.assign(view.grey.values.size(), -1);
  return true;
}

/// In px of a level, from `origin_px` of it on.
PredictedView::FaceMap PredictedView::map_of(std::int32_t face, int level,
                                             const Eigen::Vector2d& origin_px) const {
  FaceMap map;
  std::array<Eigen::Vector2d, 3> px, uv;
  std::array<double, 3> nearness{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t corner = faces_(face, static_cast<Eigen::Index>(k));
    const Vertex& vertex = vertices_[to_index(corner)];
    if (!vertex.is_in_front) return map;
    px[k] = Eigen::Vector2d(at_level(vertex.x, level), at_level(vertex.y, level)) - origin_px;
    uv[k] = flat_px_.row(corner);
    nearness[k] = vertex.nearness;
  }
  const double area = cross(px[1] - px[0], px[2] - px[0]);
  const double flat_area = cross(uv[1] - uv[0], uv[2] - uv[0]);
  if (!(std::abs(area) > 1e-6) || flat_area == 0.0) return map;
  map.shows_print = (area > 0.0) == (flat_area > 0.0);
  map.low = px[0].cwiseMin(px[1]).cwiseMin(px[2]);
  map.high = px[0].cwiseMax(px[1]).cwiseMax(px[2]);
  const double texels_per_px = std::sqrt(std::abs(flat_area / area));
  const double most = static_cast<double>(textures_.size()) - 1.0;
  const int halvings =
      static_cast<int>(std::clamp(std::round(std::log2(texels_per_px)), 0.0, most));
  map.texture = &textures_[to_index(halvings)];
  map.scale = 1.0 / static_cast<double>(1 << halvings);
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector2d a = px[(k + 1) % 3], way = px[(k + 2) % 3] - a;
    const Linear weight{(way.y() * a.x() - way.x() * a.y()) / area, -way.y() / area,
                        way.x() / area};
    map.weights[k] = weight;
    const auto add = [&](Linear& sum, double factor) {
      sum.at_origin += factor * weight.at_origin;
      sum.along_x += factor * weight.along_x;
      sum.along_y += factor * weight.along_y;
    };
    add(map.nearness, nearness[k]);
    add(map.u, nearness[k] * ((uv[k].x() + 0.5) * map.scale - 0.5));
    add(map.v, nearness[k] * ((uv[k].y() + 0.5) * map.scale - 0.5));
  }
  return map;
}

void PredictedView::draw_face(std::int32_t face) {
  const ViewLevel& view = levels_[to_index(finest_)];
  const FaceMap map = map_of(face, finest_, {view.x0, view.y0});
  if (map.texture == nullptr) return;
  if (!(map.low.y() < view.grey.height && map.high.y() >= 0.0)) return;
  const int first = static_cast<int>(std::ceil(std::max(map.low.y(), 0.0)));
  const int last = static_cast<int>(std::min(std::floor(map.high.y()), view.grey.height - 1.0));
  for (int y = first; y <= last; ++y) {
    double from = std::max(map.low.x(), 0.0), to = std::min(map.high.x(), view.grey.width - 1.0);
    for (const Linear& weight : map.weights) {
      const double at_left = weight.at(0.0, y);
      if (weight.along_x > 0.0) {
        from = std::max(from, -at_left / weight.along_x);
      } else if (weight.along_x < 0.0) {
        to = std::min(to, -at_left / weight.along_x);
      } else if (at_left < 0.0) {
        to = -1.0;
      }
    }
    if (!(from <= to)) continue;
    draw_row(map, face, y, static_cast<int>(std::ceil(from)), static_cast<int>(std::floor(to)));
  }
}

void PredictedView::draw_row(const FaceMap& map, std::int32_t face, int y, int x_begin, int x_end) {
  worked(std::max(x_end - x_begin, 0) + 1);
  ViewLevel& view = levels_[to_index(finest_)];
  const std::size_t at = to_index(y) * to_index(view.grey.width);
  for (int x = x_begin; x <= x_end; x += kLanes) {
    const auto along_row = [&](const Linear& value) {
      return static_cast<float>(value.at(x, y)) + kOffsets * static_cast<float>(value.along_x);
    };
    const Lanes nearness = along_row(map.nearness), depth = 1.0F / nearness;
    const Lanes u = along_row(map.u) * depth, v = along_row(map.v) * depth;
    const Lanes left = static_cast<float>(x_end - x) - kOffsets;
    Lanes grey = Lanes{} + kNothing;
    if (map.shows_print) grey = sample_texture(*map.texture, u, v);
    for (int k = 0; map.shows_print && mask_.present() && k < kLanes && left[k] >= 0.0F; ++k) {
      if (!is_object(u[k], v[k], map.scale)) grey[k] = kNothing;
    }
    float* nearness_at = nearness_.data() + at + to_index(x);
    float* grey_at = view.grey.values.data() + at + to_index(x);
    const Lanes nearness_before = load_lanes(nearness_at), grey_before = load_lanes(grey_at);
    const Lanes nearest = left >= 0.0F ? nearness : Lanes{};
    store_lanes(nearest > nearness_before ? nearest : nearness_before, nearness_at);
    store_lanes(nearest > nearness_before ? grey : grey_before, grey_at);
    for (int k = 0; with_faces_ && k < kLanes; ++k) {
      if (nearest[k] > nearness_before[k]) view.face[at + to_index(x + k)] = face;
    }
  }
}

void PredictedView::sample(std::int32_t face, int level, const Lattice& lattice,
                           Samples& samples) const {
  const FaceMap map = map_of(face, level, Eigen::Vector2d::Zero());
  if (map.texture == nullptr) {
    samples.values.fill(0.0F);
    return;
  }
  const double scale = 1 << level;
  const Eigen::Vector2d origin(at_level(lattice.origin_px.x(), level),
                               at_level(lattice.origin_px.y(), level));
  const Eigen::Vector2d column = lattice.along_row_px / scale,
                        row = lattice.along_column_px / scale;
  struct OnLattice {
    Lanes first;
    float along_row, along_column;
  };
  const auto on_lattice = [&](const Linear& value) {
    const auto along_row =
        static_cast<float>(value.along_x * column.x() + value.along_y * column.y());
    const auto along_column = static_cast<float>(value.along_x * row.x() + value.along_y * row.y());
    return OnLattice{static_cast<float>(value.at(origin.x(), origin.y())) + kOffsets * along_row,
                     along_row, along_column};
  };
  const OnLattice nearness = on_lattice(map.nearness), u = on_lattice(map.u), v = on_lattice(map.v);
  for (int j = 0; j < Samples::kRows; ++j) {
    for (int i = 0; i < Samples::kColumns; i += kLanes) {
      const auto at = [&](const OnLattice& value) {
        return value.first + (static_cast<float>(i) * value.along_row +
                              static_cast<float>(j) * value.along_column);
      };
      const Lanes depth = 1.0F / at(nearness);
      store_lanes(sample_texture(*map.texture, at(u) * depth, at(v) * depth),
                  samples.values.data() + j * Samples::kColumns + i);
    }
  }
}

bool PredictedView::is_drawn(const Eigen::Vector2d& place_px, double radius_px) const {
  const ViewLevel& view = levels_[to_index(finest_)];
  const Eigen::Vector2d radius = Eigen::Vector2d::Constant(radius_px);
  const Eigen::Vector2d low = place_px - radius, high = place_px + radius;
  const double left = std::round(at_level(low.x(), finest_)) - view.x0;
  const double top = std::round(at_level(low.y(), finest_)) - view.y0;
  const double right = std::round(at_level(high.x(), finest_)) - view.x0;
  const double bottom = std::round(at_level(high.y(), finest_)) - view.y0;
  if (!(left >= 0 && top >= 0 && right < view.grey.width && bottom < view.grey.height))
    return false;
  for (int y = static_cast<int>(top); y <= static_cast<int>(bottom); ++y) {
    const std::uint8_t* row = view.drawn_row(y);
    if (std::find(row + static_cast<int>(left), row + static_cast<int>(right) + 1, 0) !=
        row + static_cast<int>(right) + 1) {
      return false;
    }
  }
  return true;
}

/// True if the texel at this place of a texture at `scale` belongs to the object.
bool PredictedView::is_object(float u, float v, double scale) const {
  const auto texel = [&](float place, std::int64_t size) {
    const double whole = std::round((static_cast<double>(place) + 0.5) / scale - 0.5);
    return static_cast<std::int64_t>(std::clamp(whole, 0.0, static_cast<double>(size - 1)));
  };
  return mask_(texel(v, mask_.dim(0)), texel(u, mask_.dim(1))) != 0;
}

Eigen::Vector2d PredictedView::place_px(std::int32_t face, const Eigen::Vector3d& weights) const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double total = 0.0;
  for (int k = 0; k < 3; ++k) {
    const Vertex& vertex = vertices_[to_index(faces_(face, k))];
    if (!vertex.is_in_front) {
      return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    }
    // A point between the corners in space has the mean of their x z, y z and z.
    const double share = weights[k] / vertex.nearness;
    sum += share * Eigen::Vector2d(vertex.x, vertex.y);
    total += share;
  }
  return sum / total;
}

Eigen::Matrix2d PredictedView::jacobian(std::int32_t face) const {
  Eigen::Matrix2d px, uv;
  const Vertex& origin = vertices_[to_index(faces_(face, 0))];
  for (int k = 0; k < 2; ++k) {
    const Vertex& vertex = vertices_[to_index(faces_(face, k + 1))];
    px.col(k) = Eigen::Vector2d(vertex.x - origin.x, vertex.y - origin.y);
    uv.col(k) = (flat_px_.row(faces_(face, k + 1)) - flat_px_.row(faces_(face, 0))).transpose();
  }
  return px * uv.inverse();
}

Eigen::Vector3d PredictedView::weights_at(std::int32_t face,
                                          const Eigen::Vector2d& place_px) const {
  std::array<Eigen::Vector2d, 3> px;
  Eigen::Vector3d nearness;
  for (int k = 0; k < 3; ++k) {
    const Vertex& vertex = vertices_[to_index(faces_(face, k))];
    px[to_index(k)] = {vertex.x, vertex.y};
    nearness[k] = vertex.nearness;
  }
  // Weights in the image, then, in space, those times nearness.
  const Eigen::Vector3d in_image(cross(px[1] - place_px, px[2] - place_px),
                                 cross(px[2] - place_px, px[0] - place_px),
                                 cross(px[0] - place_px, px[1] - place_px));
  const Eigen::Vector3d weights = in_image.cwiseProduct(nearness);
  return weights / weights.sum();
}

Eigen::Matrix3d PredictedView::texel_map(std::int32_t face) const {
  const auto vertex = [&](int k) { return vertices_[to_index(faces_(face, k % 3))]; };
  Eigen::Matrix3d map = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    // Twice the area that a place spans with the side across from the corner, as in weights_at().
    const Vertex a = vertex(k + 1), b = vertex(k + 2);
    const Eigen::RowVector3d area(a.y - b.y, b.x - a.x, a.x * b.y - a.y * b.x);
    const Eigen::Vector3d texel(flat_px_(faces_(face, k), 0), flat_px_(faces_(face, k), 1), 1.0);
    map += vertex(k).nearness * texel * area;
  }
  return map;
}

}  // namespace weft::view
