// SPDX-License-Identifier: Apache-2.0
#include "selection.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_validation.hpp>

namespace weft::salient_cells {
namespace {

/// A face squeezed to less than this share of the median is as unreliable as a folded one.
constexpr double kSmallestAreaRatio = 0.02;
/// Matches with which a vertex is trusted as with any number.
constexpr int kFullTrust = 20;

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

/// Kept matches by square cells of the texture.
class MatchGrid {
 public:
  MatchGrid(const Correspondences& matches, const Points2View& flat_px, double cell_px)
      : cell_px_(cell_px), places_px_(matches.template_px.matrix<2>()) {
    low_px_ = flat_px.colwise().minCoeff().array() - cell_px;
    const Eigen::RowVector2d size_px = flat_px.colwise().maxCoeff() - low_px_;
    columns_ = cell_of(size_px.x()) + 2;
    rows_ = cell_of(size_px.y()) + 2;
    cells_.resize(to_index(columns_ * rows_));
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      worked_in_loop(i);
      if (matches.kept(i) == 0 || !places_px_.row(i).allFinite()) continue;
      const Eigen::RowVector2d from_low = places_px_.row(i) - low_px_;
      const bool on_grid = (from_low.array() >= 0.0).all() && from_low.x() < cell_px_ * columns_ &&
                           from_low.y() < cell_px_ * rows_;
      if (on_grid) cells_[cell_index(from_low)].push_back(i);
    }
  }

  /// How many lie within a cell's side of a place on the mesh, up to `most`.
  int count_near(const Eigen::RowVector2d& place_px, int most) const {
    const Eigen::RowVector2d from_low = place_px - low_px_;
    const std::int64_t column = cell_of(from_low.x()), row = cell_of(from_low.y());
    int count = 0;
    for (const std::int64_t down : {0, -1, 1}) {  // matches found in the middle are enough mostly
      for (const std::int64_t right : {0, -1, 1}) {
        for (const std::int64_t match :
             cells_[to_index((row + down) * columns_ + column + right)]) {
          const double far2 = (places_px_.row(match) - place_px).squaredNorm();
          if (far2 <= cell_px_ * cell_px_ && ++count >= most) return count;
        }
      }
    }
    return count;
  }

 private:
  std::int64_t cell_of(double px) const { return static_cast<std::int64_t>(px / cell_px_); }
  std::size_t cell_index(const Eigen::RowVector2d& from_low) const {
    return to_index(cell_of(from_low.y()) * columns_ + cell_of(from_low.x()));
  }

  double cell_px_;
  Points2 places_px_;
  Eigen::RowVector2d low_px_;
  std::int64_t columns_ = 1, rows_ = 1;
  std::vector<std::vector<std::int64_t>> cells_;  ///< [rows * columns], a ring wider than the mesh
};

/// Raises the count of each face to that of the matches around its middle.
void count_within_reach(const Template& templ, const Correspondences& correspondences,
                        const Rules& rules, Cells& cells) {
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const double diagonal_px = (flat_px.colwise().maxCoeff() - flat_px.colwise().minCoeff()).norm();
  if (!(diagonal_px > 0.0) || !std::isfinite(diagonal_px)) return;
  const MatchGrid grid(correspondences, flat_px, rules.reach * diagonal_px);
  const int most = std::max(rules.count_all ? kFullTrust : 1, rules.min_matches_per_cell);
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    worked_in_loop(f, 20);
    const std::int32_t* corner = templ.faces.row(f);
    const Eigen::RowVector2d middle_px =
        (flat_px.row(corner[0]) + flat_px.row(corner[1]) + flat_px.row(corner[2])) / 3.0;
    int& matches = cells.matches[to_index(f)];
    matches = std::max(matches, grid.count_near(middle_px, most));
  }
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
  if (rules.reach > 0.0) count_within_reach(templ, correspondences, rules, cells);
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
