// SPDX-License-Identifier: Apache-2.0
#include "template_drawing.hpp"

#include <cairo.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/rigid_alignment.hpp>
#include <weft/geometry/surface_distance.hpp>

#include "cairo_bytes.hpp"

namespace weft::cli {
namespace {

constexpr double kPanel_px = 1600.0, kLeastPanel_px = 700.0;

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Pen = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

/// Blue, green, red of a texel, 0 to 255.
Eigen::Vector3d texel(const Template& templ, std::int64_t x, std::int64_t y) {
  const bool is_grey = templ.texture.ndim() == 2;
  const std::uint8_t* at = templ.texture.row(y) + (is_grey ? x : 3 * x);
  return is_grey ? Eigen::Vector3d::Constant(at[0]) : Eigen::Vector3d(at[0], at[1], at[2]);
}

/// The texture as an image of Cairo; what is outside the mask is mixed with white by `paleness`.
Surface texture_surface(const Template& templ, double paleness) {
  const auto width = templ.texture.dim(1), height = templ.texture.dim(0);
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width),
                                             static_cast<int>(height)),
                  &cairo_surface_destroy);
  unsigned char* pixels = cairo_image_surface_get_data(surface.get());
  if (pixels == nullptr) return surface;
  const auto stride = cairo_image_surface_get_stride(surface.get());
  for (std::int64_t y = 0; y < height; ++y) {
    for (std::int64_t x = 0; x < width; ++x) {
      Eigen::Vector3d colour = texel(templ, x, y);
      if (templ.mask(y, x) == 0) colour += paleness * (Eigen::Vector3d::Constant(255.0) - colour);
      for (int c = 0; c < 3; ++c) {
        pixels[y * stride + 4 * x + c] = static_cast<unsigned char>(std::lround(colour[c]));
      }
    }
  }
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

void draw_edges(cairo_t* pen, const Points2& at, const MeshTopology& topology) {
  const auto trace = [&](bool border) {
    for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
      if ((topology.edge_faces(e, 1) < 0) != border) continue;
      const auto a = at.row(topology.edges(e, 0)), b = at.row(topology.edges(e, 1));
      cairo_move_to(pen, a.x(), a.y());
      cairo_line_to(pen, b.x(), b.y());
    }
  };
  cairo_set_line_cap(pen, CAIRO_LINE_CAP_ROUND);
  for (const bool border : {false, true}) {
    trace(border);
    cairo_set_source_rgba(pen, 0.0, 0.0, 0.0, 0.35);
    cairo_set_line_width(pen, border ? 4.5 : 3.0);
    cairo_stroke_preserve(pen);
    cairo_set_source_rgb(pen, 0.25, 0.87, 0.38);
    cairo_set_line_width(pen, border ? 2.6 : 1.3);
    cairo_stroke(pen);
  }
}

/// Mean colour of a face in the texture, at its middle and half-way to its corners.
Eigen::Vector3d face_colour(const Template& templ, const Points2& flat_px, const Faces& faces,
                            Eigen::Index f) {
  Eigen::RowVector2d middle = Eigen::RowVector2d::Zero();
  for (int k = 0; k < 3; ++k) middle += flat_px.row(faces(f, k)) / 3.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4; ++k) {
    const Eigen::RowVector2d at = k == 3 ? middle : 0.5 * (middle + flat_px.row(faces(f, k)));
    const auto within = [](double value, std::int64_t size) {
      return std::clamp<std::int64_t>(std::lround(value), 0, size - 1);
    };
    sum += texel(templ, within(at.x(), templ.texture.dim(1)), within(at.y(), templ.texture.dim(0)));
  }
  return sum / 4.0;
}

/// The object at rest as the camera of its texture sees it, turned so that its depth shows, in
/// units of the panel's size; x right, y down, z away.
Points3 seen_from_above(const Template& templ) {
  const Points3 vertices_m = templ.vertices_m.matrix<3>();
  Points3 flat = Points3::Zero(vertices_m.rows(), 3);
  flat.leftCols<2>() = templ.flat_px.matrix<2>();
  const auto facing = align_points(vertices_m, flat);
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(-0.6, Eigen::Vector3d::UnitY()))
                                   .toRotationMatrix();
  Points3 seen = facing ? transform_points(*facing, vertices_m) : vertices_m;
  seen = (seen * turn.transpose()).eval();
  seen.rowwise() -= 0.5 * (seen.colwise().maxCoeff() + seen.colwise().minCoeff()).eval();
  return seen / (seen.leftCols<2>().colwise().maxCoeff().maxCoeff() * 2.0);
}

/// From the furthest face to the nearest.
void draw_object(cairo_t* pen, const Template& templ, double size_px) {
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const Faces faces = templ.faces.matrix<3>();
  const Points3 seen = seen_from_above(templ) * (0.9 * size_px);
  const auto depth = [&](Eigen::Index f) {
    return seen(faces(f, 0), 2) + seen(faces(f, 1), 2) + seen(faces(f, 2), 2);
  };
  std::vector<Eigen::Index> order(static_cast<std::size_t>(faces.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return depth(a) > depth(b); });
  for (const Eigen::Index f : order) {
    const Eigen::RowVector3d a = seen.row(faces(f, 0));
    const Eigen::RowVector3d normal =
        (seen.row(faces(f, 1)) - a).cross(seen.row(faces(f, 2)) - a).normalized();
    Eigen::Vector3d colour = face_colour(templ, flat_px, faces, f) / 255.0;
    if (normal.z() > 0.0) colour.setConstant(0.82);  // the back is blank
    colour *= 0.55 + 0.45 * std::abs(normal.z());
    for (int k = 0; k < 3; ++k) {
      cairo_line_to(pen, seen(faces(f, k), 0) + 0.5 * size_px,
                    seen(faces(f, k), 1) + 0.5 * size_px);
    }
    cairo_close_path(pen);
    cairo_set_source_rgb(pen, colour[2], colour[1], colour[0]);
    cairo_fill_preserve(pen);
    cairo_set_source_rgba(pen, 0.1, 0.45, 0.2, 0.8);
    cairo_set_line_width(pen, 1.2);
    cairo_stroke(pen);
  }
}

}  // namespace

std::string draw_template(const Template& templ) {
  const auto width = static_cast<double>(templ.texture.dim(1));
  const auto height = static_cast<double>(templ.texture.dim(0));
  const double largest = std::max(width, height);
  const double scale = std::clamp(largest, kLeastPanel_px, kPanel_px) / largest;
  const bool flat = coplanar(templ.vertices_m.matrix<3>());
  const double panel_px = scale * std::max(height, 0.6 * width);
  const int out_width = static_cast<int>(scale * width + (flat ? 0.0 : panel_px));
  const int out_height = static_cast<int>(flat ? scale * height : panel_px);
  const Surface canvas(cairo_image_surface_create(CAIRO_FORMAT_RGB24, out_width, out_height),
                       &cairo_surface_destroy);
  const Pen pen(cairo_create(canvas.get()), &cairo_destroy);
  cairo_set_source_rgb(pen.get(), 1.0, 1.0, 1.0);
  cairo_paint(pen.get());
  const Surface texture = texture_surface(templ, 0.6);
  cairo_save(pen.get());
  cairo_scale(pen.get(), scale, scale);
  cairo_set_source_surface(pen.get(), texture.get(), 0.0, 0.0);
  cairo_paint(pen.get());
  cairo_restore(pen.get());
  // Cairo's pixels begin at whole numbers, Weft's texels are centred there.
  const Points2 at = scale * (templ.flat_px.matrix<2>().array() + 0.5);
  draw_edges(pen.get(), at, *build_topology(templ.faces.matrix<3>(), at.rows()));
  if (!flat) {
    cairo_translate(pen.get(), scale * width, 0.0);
    draw_object(pen.get(), templ, panel_px);
  }
  return to_png(canvas.get());
}

std::string draw_texture(const Template& templ) {
  return to_png(texture_surface(templ, 0.0).get());
}

}  // namespace weft::cli
