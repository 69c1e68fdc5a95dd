// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/template_survey.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/solid/validation.hpp>
#include <weft/geometry/surface_distance.hpp>
#include <weft/geometry/texture_metric.hpp>

namespace weft {
namespace {

constexpr double kMmPerM = 1000.0, kCm2PerM2 = 1e4, kCm3PerM3 = 1e6;

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
                   TemplateSurvey& survey) {
  survey.edges = topology.edges.rows();
  survey.border_edges = static_cast<Eigen::Index>(topology.boundary_edges.size());
  survey.shortest_edge_mm = std::numeric_limits<double>::infinity();
  for (Eigen::Index e = 0; e < survey.edges; ++e) {
    const auto side = vertices_m.row(topology.edges(e, 0)) - vertices_m.row(topology.edges(e, 1));
    const double length_mm = kMmPerM * side.norm();
    survey.shortest_edge_mm = std::min(survey.shortest_edge_mm, length_mm);
    survey.longest_edge_mm = std::max(survey.longest_edge_mm, length_mm);
  }
  survey.mean_edge_mm = kMmPerM * mean_edge_length(vertices_m, topology.edges);
}

Eigen::Index count_charts(const MeshTopology& topology, Eigen::Index vertex_count) {
  std::vector<std::int32_t> up(to_index(vertex_count));
  std::iota(up.begin(), up.end(), 0);
  const auto root = [&](std::int32_t v) {
    while (up[to_index(v)] != v) v = up[to_index(v)] = up[to_index(up[to_index(v)])];
    return v;
  };
  Eigen::Index charts = vertex_count;
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    const std::int32_t a = root(topology.edges(e, 0)), b = root(topology.edges(e, 1));
    if (a == b) continue;
    up[to_index(b)] = a;
    --charts;
  }
  return charts;
}

void measure_solid(const Template& templ, const Faces& faces, TemplateSurvey& survey) {
  const auto welded =
      build_topology(welded_faces(faces, templ.welded_vertex), templ.vertices_m.rows());
  survey.seam_edges = survey.edges - welded->edges.rows();
  survey.open_edges = static_cast<Eigen::Index>(welded->boundary_edges.size());
  if (!templ.is_solid()) return;
  survey.nodes = templ.nodes_m.rows();
  survey.tetrahedra = templ.tetrahedra.rows();
  const auto nodes_m = templ.nodes_m.matrix<3>();
  const auto tetrahedra = templ.tetrahedra.matrix<4>();
  for (Eigen::Index e = 0; e < survey.tetrahedra; ++e) {
    survey.solid_cm3 += kCm3PerM3 * tetrahedron_volume(nodes_m, tetrahedra, e);
  }
}

}  // namespace

TemplateSurvey survey_template(const Template& templ) {
  const Points3 vertices_m = templ.vertices_m.matrix<3>();
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const Faces faces = templ.faces.matrix<3>();
  TemplateSurvey survey;
  survey.vertices = vertices_m.rows();
  survey.faces = faces.rows();
  const auto topology = build_topology(faces, vertices_m.rows());
  measure_edges(vertices_m, *topology, survey);
  survey.charts = count_charts(*topology, vertices_m.rows());
  measure_solid(templ, faces, survey);
  survey.least_angle_deg = least_angle_deg(vertices_m, faces);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    survey.area_cm2 += kCm2PerM2 * face_area(vertices_m, faces, f);
  }
  survey.size_mm = kMmPerM * (vertices_m.colwise().maxCoeff() - vertices_m.colwise().minCoeff());
  const TexelPitch pitch = texel_pitch(vertices_m, flat_px, faces);
  survey.texel_mm = kMmPerM * pitch.m_per_px;
  survey.distortion = pitch.distortion;
  survey.flat = coplanar(vertices_m);
  survey.texture_width_px = templ.texture.dim(1);
  survey.texture_height_px = templ.texture.dim(0);
  const auto* mask = templ.mask.data();
  const auto inside = std::count_if(mask, mask + templ.mask.size(), [](auto m) { return m != 0; });
  survey.mask_share = static_cast<double>(inside) / static_cast<double>(templ.mask.size());
  return survey;
}

std::vector<std::string> warnings_of(const TemplateSurvey& numbers) {
  constexpr double kMostStretch = 0.1;
  std::vector<std::string> warnings;
  const auto percent = [](double share) { return std::to_string(std::lround(100.0 * share)); };
  if (numbers.distortion >= kMostStretch) {
    warnings.push_back("the texture is stretched by up to " + percent(numbers.distortion) +
                       " % on the surface: do the texture coordinates belong to this mesh? Truth "
                       "and sizes in the texture are off by as much there");
  }
  const double ratio = numbers.texel_mm.maxCoeff() / numbers.texel_mm.minCoeff() - 1.0;
  if (ratio >= kMostStretch) {
    warnings.push_back(
        "texels are " + percent(ratio) + " % " +
        (numbers.texel_mm.x() > numbers.texel_mm.y() ? "wider than high" : "higher than wide") +
        ": check the width and the height of the object, and that the image shows the whole "
        "object");
  }
  return warnings;
}

}  // namespace weft
