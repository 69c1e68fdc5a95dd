// SPDX-License-Identifier: Apache-2.0
#include "selection.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/mesh_validation.hpp>

namespace weft::salient_cells {
namespace {

/// A face squeezed to less than this share of the median is as unreliable as a folded one.
constexpr double kSmallestAreaRatio = 0.02;

bool inside(const Camera& camera, double x_px, double y_px, double margin) {
  const auto width = static_cast<double>(camera.width_px);
  const auto height = static_cast<double>(camera.height_px);
  return x_px >= -0.5 - margin * width && x_px <= (1.0 + margin) * width - 0.5 &&
         y_px >= -0.5 - margin * height && y_px <= (1.0 + margin) * height - 0.5;
}

bool evaluated(const WarpSamples& warped, std::int64_t vertex) {
  return warped.valid(vertex) != 0 && std::isfinite(warped.xy_px(vertex, 0)) &&
         std::isfinite(warped.xy_px(vertex, 1));
}

/// Area in the image over area in the texture, negative where the warp turns the face over; NaN
/// where the warp could not be evaluated.
std::vector<double> area_ratios(const Template& templ, const WarpSamples& warped) {
  const Points2 flat_px = templ.flat_px.matrix<2>(), image_px = warped.xy_px.matrix<2>();
  const Faces faces = templ.faces.matrix<3>();
  std::vector<double> ratios(to_index(faces.rows()), std::nan(""));
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f, 3);
    if (evaluated(warped, faces(f, 0)) && evaluated(warped, faces(f, 1)) &&
        evaluated(warped, faces(f, 2))) {
      ratios[to_index(f)] =
          signed_area_px2(image_px, faces, f) / signed_area_px2(flat_px, faces, f);
    }
  }
  return ratios;
}

/// Takes back the faces of minority orientation and the squeezed ones.
void reject_folded(const std::vector<double>& ratios, Cells& cells) {
  std::vector<double> sizes;
  int upright = 0, turned = 0;
  for (std::size_t f = 0; f < ratios.size(); ++f) {
    if (cells.salient[f] == 0 || !std::isfinite(ratios[f])) continue;
    sizes.push_back(std::abs(ratios[f]));
    ++(ratios[f] < 0.0 ? turned : upright);
  }
  const double sign = turned > upright ? -1.0 : 1.0;
  const double least = kSmallestAreaRatio * median_in_place(sizes);
  for (std::size_t f = 0; f < ratios.size(); ++f) {
    if (cells.salient[f] == 0 || !std::isfinite(ratios[f]) || sign * ratios[f] >= least) continue;
    cells.salient[f] = 0;
    ++cells.folded_faces;
  }
}

double salient_area_share(const Template& templ, const std::vector<std::uint8_t>& salient) {
  const Points3 vertices_m = templ.vertices_m.matrix<3>();
  const Faces faces = templ.faces.matrix<3>();
  double covered = 0.0, all = 0.0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f, 2);
    const double area = face_area(vertices_m, faces, f);
    all += area;
    if (salient[to_index(f)] != 0) covered += area;
  }
  return all > 0.0 ? covered / all : 0.0;
}

}  // namespace

int Cells::count() const { return static_cast<int>(std::count(salient.begin(), salient.end(), 1)); }

Result<Cells> find_cells(const Template& templ, const Correspondences& correspondences,
                         const WarpSamples& warped, const Rules& rules) {
  const std::int64_t face_count = templ.faces.rows();
  Cells cells;
  cells.matches.assign(to_index(face_count), 0);
  for (std::int64_t i = 0; i < correspondences.count(); ++i) {
    const std::int32_t face = correspondences.face(i);
    if (face >= face_count) {
      return Error{Errc::invalid_data,
                   "match " + std::to_string(i) + " lies in face " + std::to_string(face) +
                       ", but the template has " + std::to_string(face_count) +
                       " faces: give the matches and the template of one pipeline"};
    }
    if (correspondences.kept(i) == 0) continue;
    ++(face < 0 ? cells.matches_without_face : cells.matches[to_index(face)]);
  }
  for (const int matches : cells.matches) {
    cells.salient.push_back(matches >= rules.min_matches_per_cell ? 1 : 0);
  }
  if (rules.reject_folded) reject_folded(area_ratios(templ, warped), cells);
  cells.coverage = salient_area_share(templ, cells.salient);
  return cells;
}

std::vector<SalientVertex> find_vertices(const Template& templ, const Camera& camera,
                                         const Cells& cells, const WarpSamples& warped,
                                         const std::optional<Visibility>& visibility,
                                         const Rules& rules, Dropped& dropped) {
  std::vector<SalientVertex> all(to_index(templ.vertices_m.rows()), {-1, 0, 0, 0});
  for (std::int32_t f = 0; f < templ.faces.rows(); ++f) {
    worked_in_loop(f);
    if (cells.salient[to_index(f)] == 0) continue;
    for (int corner = 0; corner < 3; ++corner) {
      SalientVertex& entry = all[to_index(templ.faces(f, corner))];
      if (entry.vertex < 0) entry = {templ.faces(f, corner), f, corner, 0};
      entry.matches += cells.matches[to_index(f)];
    }
  }
  std::vector<SalientVertex> chosen;
  for (const SalientVertex& entry : all) {
    if (entry.vertex < 0) continue;
    if (!evaluated(warped, entry.vertex)) {
      ++dropped.not_evaluated;
    } else if (!inside(camera, warped.xy_px(entry.vertex, 0), warped.xy_px(entry.vertex, 1),
                       rules.image_margin)) {
      ++dropped.outside;
    } else if (visibility && visibility->visible(entry.vertex) == 0) {
      ++dropped.hidden;
    } else {
      chosen.push_back(entry);
    }
  }
  return chosen;
}

std::vector<std::int64_t> find_matches(const Template& templ, const Camera& camera,
                                       const Cells& cells, const Correspondences& correspondences,
                                       const std::optional<Visibility>& visibility,
                                       const Rules& rules, Dropped& dropped) {
  const auto hidden = [&](std::int32_t face) {
    if (!visibility) return false;
    const std::int32_t* corner = templ.faces.row(face);
    return visibility->visible(corner[0]) == 0 && visibility->visible(corner[1]) == 0 &&
           visibility->visible(corner[2]) == 0;
  };
  std::vector<std::int64_t> chosen;
  for (std::int64_t i = 0; i < correspondences.count(); ++i) {
    const std::int32_t face = correspondences.face(i);
    if (correspondences.kept(i) == 0 || face < 0 || cells.salient[to_index(face)] == 0) {
      continue;
    }
    if (!inside(camera, correspondences.image_px(i, 0), correspondences.image_px(i, 1),
                rules.image_margin)) {
      ++dropped.outside;
    } else if (hidden(face)) {
      ++dropped.hidden;
    } else {
      chosen.push_back(i);
    }
  }
  return chosen;
}

}  // namespace weft::salient_cells
