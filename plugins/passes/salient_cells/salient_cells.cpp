// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/sdk/pass.hpp>

#include "selection.hpp"

namespace weft::salient_cells {
namespace {

/// Below these a shape is determined by its prior rather than by the image.
constexpr std::size_t kFewSightlines = 8;
constexpr double kLowCoverage = 0.1;

/// The points on a ray: the vertices of salient faces at their warped positions, or the matches.
enum class Mode { vertices, matches };

/// A record of `count` sightlines, all weights in their faces 0.
Sightlines make_sightlines(std::size_t count) {
  const auto n = static_cast<std::int64_t>(count);
  Sightlines lines;
  lines.vertex = Array<std::int32_t>({n});
  lines.face = Array<std::int32_t>({n});
  lines.barycentrics = Array<double>({n, 3}, 0.0);
  lines.pixel_px = Array<double>({n, 2});
  lines.ray = Array<double>({n, 3});
  lines.weight = Array<double>({n});
  return lines;
}

/// Selection of sightlines: a vertex is put on the ray of its warped position if at least one face
/// around it holds kept matches (ROBUSfT, step 3).
class SalientCells final : public Pass {
 public:
  static constexpr About kAbout{
      .reference = "paper: Shetab-Bushehri et al., ROBUSfT, arXiv:2301.04037 (2023), step 3",
      .needs = "warp_samples correspondences",
      .reads = "visibility",
      .produces = "sightlines"};

  explicit SalientCells(Params& p) {
    p.choice(
        "mode", mode_, {{"vertices", Mode::vertices}, {"matches", Mode::matches}},
        "points that get sightlines; vertices: warped vertices; matches: the matches themselves");
    p.read("min_matches_per_cell", rules_.min_matches_per_cell, "", {1, 1000000},
           "minimum number of kept matches of a salient face");
    p.read("reach", rules_.reach, "share of the template's diagonal", {0.0, 1.0},
           "distance from the centre of a face within which a match makes it salient too");
    p.read("min_sightlines", min_sightlines_, "", {3, 1000000},
           "minimum number of sightlines for a result");
    p.read("reject_folded", rules_.reject_folded,
           "rejection of faces that the warp turns over or squeezes below 2 % of the median area");
    p.read("image_margin", rules_.image_margin, "share of the image", {0, 1000},
           "maximum distance of a point outside the image");
    p.read("weight_by_matches", weight_by_matches_,
           "weights 1 - exp(-n/2) of vertices with n kept matches in their salient faces; false: "
           "weight 1");
  }

  Result<PassOutput> run(const PassInput& in) override {
    if (auto checked = check(in); !checked) return checked.error();
    rules_.count_all = weight_by_matches_;
    auto cells = find_cells(in.templ, *in.correspondences, *in.warp_samples, rules_);
    if (!cells) return cells.error();
    Dropped dropped;
    PassOutput out;
    out.sightlines = mode_ == Mode::vertices ? from_vertices(in, *cells, dropped)
                                             : from_matches(in, *cells, dropped);
    Sightlines& lines = *out.sightlines;
    lines.coverage = cells->coverage;
    explain(*cells, dropped, lines.diag);
    const auto count = to_index(lines.count());
    const std::string number = std::to_string(count);
    if (count < to_index(min_sightlines_)) {
      return no_result("too few sightlines: " + number + " of at least " +
                       std::to_string(min_sightlines_));
    }
    const bool uncertain = count < kFewSightlines || lines.coverage < kLowCoverage;
    lines.diag.set("low_confidence", uncertain ? 1.0 : 0.0);
    if (!uncertain) return out;
    return degenerate(std::move(out), number + " sightlines cover " +
                                          std::to_string(std::lround(100.0 * cells->coverage)) +
                                          " % of the template");
  }

 private:
  static Result<void> check(const PassInput& in) {
    if (!in.warp_samples || !in.correspondences) {
      return Error{Errc::invalid_data, "needs 'warp_samples' and 'correspondences'"};
    }
    const std::int64_t vertices = in.templ.vertices_m.rows();
    if (in.warp_samples->xy_px.rows() != vertices ||
        (in.visibility && in.visibility->visible.rows() != vertices)) {
      return Error{Errc::invalid_data, "warp samples and visibility must be of the " +
                                           std::to_string(vertices) + " vertices of the template"};
    }
    return check_face_indices(in.templ.faces.matrix<3>(), vertices);
  }

  Sightlines from_vertices(const PassInput& in, const Cells& cells, Dropped& dropped) const {
    const auto chosen =
        find_vertices(in.templ, in.camera, cells, *in.warp_samples, in.visibility, rules_, dropped);
    Sightlines lines = make_sightlines(chosen.size());
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const auto i = static_cast<std::int64_t>(k);
      lines.vertex(i) = chosen[k].vertex;
      worked(5);
      lines.face(i) = chosen[k].face;
      lines.barycentrics(i, chosen[k].corner) = 1.0;
      lines.weight(i) = weight_by_matches_ ? 1.0 - std::exp(-0.5 * chosen[k].matches) : 1.0;
      place(in.camera, in.warp_samples->xy_px.row(chosen[k].vertex), i, lines);
    }
    return lines;
  }

  Sightlines from_matches(const PassInput& in, const Cells& cells, Dropped& dropped) const {
    const auto chosen = find_matches(in.templ, in.camera, cells, *in.correspondences, in.visibility,
                                     rules_, dropped);
    Sightlines lines = make_sightlines(chosen.size());
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const auto i = static_cast<std::int64_t>(k);
      lines.vertex(i) = -1;
      worked(5);
      lines.face(i) = in.correspondences->face(chosen[k]);
      lines.weight(i) = 1.0;
      for (int c = 0; c < 3; ++c) {
        lines.barycentrics(i, c) = in.correspondences->barycentrics(chosen[k], c);
      }
      place(in.camera, in.correspondences->image_px.row(chosen[k]), i, lines);
    }
    return lines;
  }

  static void place(const Camera& camera, const double* xy_px, std::int64_t i, Sightlines& lines) {
    const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
    const Eigen::Vector2d pixel(xy_px[0], xy_px[1]);
    lines.pixel_px.matrix<2>().row(i) = pixel.transpose();
    lines.ray.matrix<3>().row(i) = unit_ray(pinhole, pixel).transpose();
  }

  static void explain(const Cells& cells, const Dropped& dropped, Diagnostics& diag) {
    diag.set("salient_faces", cells.count());
    diag.set("folded_faces", cells.folded_faces);
    diag.set("matches_without_face", cells.matches_without_face);
    diag.set("dropped_not_evaluated", dropped.not_evaluated);
    diag.set("dropped_outside", dropped.outside);
    diag.set("dropped_hidden", dropped.hidden);
  }

  Mode mode_ = Mode::vertices;
  Rules rules_;
  int min_sightlines_ = 3;
  bool weight_by_matches_ = false;
};

}  // namespace
}  // namespace weft::salient_cells

using weft::salient_cells::SalientCells;
WEFT_PLUGIN(SalientCells, "passes/salient_cells", "1.1.0",
            "Gives sightlines of the mesh vertices in cells that contain matches.")
