// SPDX-License-Identifier: Apache-2.0
#include "cli/template/template_text.hpp"

#include <fmt/format.h>

namespace weft::cli {

namespace {

std::string structure_text(const TemplateSurvey& f) {
  std::string text = fmt::format(
      "charts    {} in the texture, {} edges at seams, {}\n", f.charts, f.seam_edges,
      f.open_edges == 0 ? std::string("closed") : fmt::format("{} open edges", f.open_edges));
  if (f.tetrahedra == 0) return text;
  return text + fmt::format("solid     {} nodes, {} tetrahedra, {:.1f} cm^3\n", f.nodes,
                            f.tetrahedra, f.solid_cm3);
}

}  // namespace

std::string numbers_text(const TemplateSurvey& f) {
  std::string text = fmt::format(
      "mesh      {} vertices, {} faces, {} edges, {} of them on the border\n"
      "edges     {:.2f} mm on average, {:.2f} to {:.2f}; angles from {:.1f} degrees\n"
      "size      {:.1f} x {:.1f} x {:.1f} mm, {:.1f} cm^2, {}\n"
      "texture   {} x {} px, {:.1f} % of it the object; a texel is {:.4f} x {:.4f} mm\n"
      "unrolled  faces are stretched by up to {:.2f} % in the texture\n",
      f.vertices, f.faces, f.edges, f.border_edges, f.mean_edge_mm, f.shortest_edge_mm,
      f.longest_edge_mm, f.least_angle_deg, f.size_mm.x(), f.size_mm.y(), f.size_mm.z(), f.area_cm2,
      f.flat ? "flat" : "curved", f.texture_width_px, f.texture_height_px, 100.0 * f.mask_share,
      f.texel_mm.x(), f.texel_mm.y(), 100.0 * f.distortion);
  const bool is_plain = f.charts == 1 && f.seam_edges == 0 && f.tetrahedra == 0;
  return is_plain ? text : text + structure_text(f);
}

nlohmann::ordered_json numbers_json(const TemplateSurvey& f) {
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
          {"mask_share", f.mask_share},
          {"charts", f.charts},
          {"seam_edges", f.seam_edges},
          {"open_edges", f.open_edges},
          {"nodes", f.nodes},
          {"tetrahedra", f.tetrahedra},
          {"solid_cm3", f.solid_cm3}};
}

std::string texture_text(const TextureSurvey& f) {
  return fmt::format(
      "matches   {} keypoints in the texture, about {} matches to be expected in a view of {:.0f} "
      "px; {:.0f} % of the keypoints have a twin elsewhere in the texture\n"
      "gap       no match within {:.0f} mm of ({:.0f}, {:.0f}) px of the texture, nowhere a wider "
      "one\n",
      f.keypoints, f.expected_matches, f.view_px, 100.0 * f.twin_share, 0.5 * f.gap_mm,
      f.gap_px.x(), f.gap_px.y());
}

nlohmann::ordered_json texture_json(const TextureSurvey& f) {
  return {{"keypoints", f.keypoints}, {"expected_matches", f.expected_matches},
          {"view_px", f.view_px},     {"twin_share", f.twin_share},
          {"gap_mm", f.gap_mm},       {"gap_px", {f.gap_px.x(), f.gap_px.y()}}};
}

}  // namespace weft::cli
