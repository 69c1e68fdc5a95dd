// SPDX-License-Identifier: Apache-2.0
#include "template_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/surface_distance.hpp>
#include <weft/geometry/texture_metric.hpp>

namespace weft::cli {
namespace {

constexpr double kMmPerM = 1000.0, kCm2PerM2 = 1e4;

double least_angle_deg(const Points3& vertices_m, const Faces& faces) {
  double least = M_PI;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector3d corner = vertices_m.row(faces(f, k));
      const Eigen::RowVector3d a = vertices_m.row(faces(f, (k + 1) % 3)) - corner;
      const Eigen::RowVector3d b = vertices_m.row(faces(f, (k + 2) % 3)) - corner;
      least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)));
    }
  }
  return least * 180.0 / M_PI;
}

void measure_edges(const Points3& vertices_m, const MeshTopology& topology,
                   TemplateFigures& figures) {
  figures.edges = topology.edges.rows();
  figures.border_edges = static_cast<Eigen::Index>(topology.boundary_edges.size());
  figures.shortest_edge_mm = std::numeric_limits<double>::infinity();
  for (Eigen::Index e = 0; e < figures.edges; ++e) {
    const auto side = vertices_m.row(topology.edges(e, 0)) - vertices_m.row(topology.edges(e, 1));
    const double length_mm = kMmPerM * side.norm();
    figures.shortest_edge_mm = std::min(figures.shortest_edge_mm, length_mm);
    figures.longest_edge_mm = std::max(figures.longest_edge_mm, length_mm);
  }
  figures.mean_edge_mm = kMmPerM * mean_edge_length(vertices_m, topology.edges);
}

}  // namespace

TemplateFigures measure_template(const Template& templ) {
  const Points3 vertices_m = templ.vertices_m.matrix<3>();
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const Faces faces = templ.faces.matrix<3>();
  TemplateFigures figures;
  figures.vertices = vertices_m.rows();
  figures.faces = faces.rows();
  measure_edges(vertices_m, *build_topology(faces, vertices_m.rows()), figures);
  figures.least_angle_deg = least_angle_deg(vertices_m, faces);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    figures.area_cm2 += kCm2PerM2 * face_area(vertices_m, faces, f);
  }
  figures.size_mm = kMmPerM * (vertices_m.colwise().maxCoeff() - vertices_m.colwise().minCoeff());
  const TexelPitch pitch = texel_pitch(vertices_m, flat_px, faces);
  figures.texel_mm = kMmPerM * pitch.m_per_px;
  figures.distortion = pitch.distortion;
  figures.flat = coplanar(vertices_m);
  figures.texture_width_px = templ.texture.dim(1);
  figures.texture_height_px = templ.texture.dim(0);
  const auto* mask = templ.mask.data();
  const auto inside = std::count_if(mask, mask + templ.mask.size(), [](auto m) { return m != 0; });
  figures.mask_share = static_cast<double>(inside) / static_cast<double>(templ.mask.size());
  return figures;
}

std::string figures_text(const TemplateFigures& f) {
  return fmt::format(
      "mesh      {} vertices, {} faces, {} edges, {} of them on the border\n"
      "edges     {:.2f} mm on average, {:.2f} to {:.2f}; angles from {:.1f} degrees\n"
      "size      {:.1f} x {:.1f} x {:.1f} mm, {:.1f} cm^2, {}\n"
      "texture   {} x {} px, {:.1f} % of it the object; a texel is {:.4f} x {:.4f} mm\n"
      "unrolled  faces are stretched by up to {:.2f} % in the texture\n",
      f.vertices, f.faces, f.edges, f.border_edges, f.mean_edge_mm, f.shortest_edge_mm,
      f.longest_edge_mm, f.least_angle_deg, f.size_mm.x(), f.size_mm.y(), f.size_mm.z(), f.area_cm2,
      f.flat ? "flat" : "curved", f.texture_width_px, f.texture_height_px, 100.0 * f.mask_share,
      f.texel_mm.x(), f.texel_mm.y(), 100.0 * f.distortion);
}

nlohmann::ordered_json figures_json(const TemplateFigures& f) {
  return {{"vertices", f.vertices},
          {"faces", f.faces},
          {"edges", f.edges},
          {"border_edges", f.border_edges},
          {"shortest_edge_mm", f.shortest_edge_mm},
          {"mean_edge_mm", f.mean_edge_mm},
          {"longest_edge_mm", f.longest_edge_mm},
          {"least_angle_deg", f.least_angle_deg},
          {"area_cm2", f.area_cm2},
          {"size_mm", {f.size_mm.x(), f.size_mm.y(), f.size_mm.z()}},
          {"texel_mm", {f.texel_mm.x(), f.texel_mm.y()}},
          {"distortion", f.distortion},
          {"flat", f.flat},
          {"texture_px", {f.texture_width_px, f.texture_height_px}},
          {"mask_share", f.mask_share}};
}

}  // namespace weft::cli
