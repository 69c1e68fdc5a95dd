// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/camera_model.hpp>

namespace weft {

/// What was seen in a frame, and how much of it a shape explains.
struct ShapeEvidence {
  int kept = 0;      ///< [] matches that filters left; of sightlines, where no matches are wired
  int agreeing = 0;  ///< [] of these, seen within 3 px of their place on the shape
  double coverage = 0.0;  ///< [] 0 to 1, share of what the camera sees that lies near agreeing ones
  int needed = 0;         ///< [] agreeing ones: 30 matches, 8 sightlines; 0 where neither is wired
};

/// The rule for the shapes of all solvers: `estimated` if it is likelier right than wrong, and if
/// the image shows it, widely and more than by chance; otherwise `weak`. Where a solver takes
/// neither matches nor sightlines, its confidence alone tells.
inline ShapeState state_of(const ShapeEvidence& evidence, double confidence) {
  constexpr double kLeastShare = 0.25, kLeastCoverage = 0.25, kLeastConfidence = 0.5;
  const bool shown = evidence.needed == 0 || (evidence.agreeing >= evidence.needed &&
                                              evidence.agreeing >= kLeastShare * evidence.kept &&
                                              evidence.coverage >= kLeastCoverage);
  return shown && confidence >= kLeastConfidence ? ShapeState::estimated : ShapeState::weak;
}

/// Gathers the evidence for one shape. Coverage is counted in square cells of the texture, twelve
/// along the diagonal of the template, so that it does not depend on the mesh: of those with a
/// corner or centre of a face that shows its front to the camera within the image, the share with
/// an agreeing match.
class EvidenceCount {
 public:
  /// `vertices_m` [V,3] m, camera frame, of the template's vertices.
  EvidenceCount(const Template& templ, const Camera& camera, const Points3View& vertices_m)
      : faces_(templ.faces.matrix<3>()),
        flat_px_(templ.flat_px.matrix<2>()),
        camera_{camera.fx, camera.fy, camera.cx, camera.cy},
        vertices_m_(vertices_m) {
    low_px_ = flat_px_.colwise().minCoeff();
    const Eigen::RowVector2d size_px = flat_px_.colwise().maxCoeff() - low_px_;
    cell_px_ = std::max(size_px.norm() / kCellsAlongDiagonal, 1e-9);
    columns_ = cell_along(size_px.x()) + 1;
    cells_.assign(to_index(columns_ * (cell_along(size_px.y()) + 1)), kNothing);
    mark_seen(camera);
  }

  ShapeEvidence of(const Correspondences& matches) {
    evidence_.needed = 30;
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      if (matches.kept(i) == 0) continue;
      ++evidence_.kept;
      if (matches.face(i) < 0) continue;
      add(matches.face(i), matches.barycentrics.matrix<3>().row(i),
          matches.image_px.matrix<2>().row(i));
    }
    return counted();
  }

  /// Where no matches are wired: the sightlines of positive weight.
  ShapeEvidence of(const Sightlines& lines) {
    evidence_.needed = 8;
    for (std::int64_t i = 0; i < lines.count(); ++i) {
      if (lines.weight(i) == 0.0) continue;
      ++evidence_.kept;
      const Eigen::Vector2d seen_px = lines.pixel_px.matrix<2>().row(i);
      if (lines.vertex(i) >= 0) {
        add_place(vertices_m_.row(lines.vertex(i)), flat_px_.row(lines.vertex(i)), seen_px);
      } else {
        add(lines.face(i), lines.barycentrics.matrix<3>().row(i), seen_px);
      }
    }
    return counted();
  }

 private:
  static constexpr double kAgreeingPx = 3.0, kCellsAlongDiagonal = 12.0;
  enum Cell : std::uint8_t { kNothing = 0, kSeen = 1, kShown = 2 };

  std::int64_t cell_along(double from_start_px) const {
    return static_cast<std::int64_t>(from_start_px / cell_px_);
  }

  void mark(const Eigen::RowVector2d& place_px, Cell before, Cell after) {
    const Eigen::RowVector2d from_start_px = place_px - low_px_;
    const std::int64_t index =
        cell_along(from_start_px.y()) * columns_ + cell_along(from_start_px.x());
    if (index < 0 || index >= static_cast<std::int64_t>(cells_.size())) return;
    Cell& cell = cells_[to_index(index)];
    if (cell == before) cell = after;
  }

  /// Faces are counter-clockwise as the camera sees their front; v grows downwards.
  void mark_seen(const Camera& camera) {
    const Points2 pixels = project_points(camera_, vertices_m_);
    for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
      const std::array corners{faces_(f, 0), faces_(f, 1), faces_(f, 2)};
      const Eigen::RowVector2d a = pixels.row(corners[0]);
      const Eigen::RowVector2d b = pixels.row(corners[1]) - a, c = pixels.row(corners[2]) - a;
      const bool front = b.x() * c.y() - b.y() * c.x() < 0.0;  // false for NaN
      const Eigen::RowVector2d centre = a + (b + c) / 3.0;
      if (!front || !camera.shows(centre.x(), centre.y())) continue;
      Eigen::RowVector2d middle_px = Eigen::RowVector2d::Zero();
      for (const std::int32_t v : corners) {
        mark(flat_px_.row(v), kNothing, kSeen);
        middle_px += flat_px_.row(v) / 3.0;
      }
      mark(middle_px, kNothing, kSeen);
    }
  }

  void add(std::int32_t face, const Eigen::Vector3d& weights, const Eigen::Vector2d& seen_px) {
    add_place(interpolate(vertices_m_, faces_, face, weights),
              interpolate(flat_px_, faces_, face, weights).transpose(), seen_px);
  }

  void add_place(const Eigen::Vector3d& place_m, const Eigen::RowVector2d& place_px,
                 const Eigen::Vector2d& seen_px) {
    if (!((project(camera_, place_m) - seen_px).norm() < kAgreeingPx)) return;
    ++evidence_.agreeing;
    mark(place_px, kSeen, kShown);
  }

  ShapeEvidence counted() {
    const auto shown = std::count(cells_.begin(), cells_.end(), kShown);
    const auto empty = std::count(cells_.begin(), cells_.end(), kNothing);
    const auto all = static_cast<std::int64_t>(cells_.size()) - empty;
    evidence_.coverage = all == 0 ? 0.0 : static_cast<double>(shown) / static_cast<double>(all);
    return evidence_;
  }

  FacesView faces_;
  Points2View flat_px_;
  Pinhole camera_;
  Points3View vertices_m_;
  Eigen::RowVector2d low_px_;
  double cell_px_ = 1.0;
  std::int64_t columns_ = 1;
  std::vector<Cell> cells_;
  ShapeEvidence evidence_;
};

/// By the matches where they are wired, else by the sightlines.
inline ShapeEvidence shape_evidence(const Template& templ, const Camera& camera,
                                    const Points3View& vertices_m,
                                    const std::optional<Correspondences>& matches,
                                    const std::optional<Sightlines>& sightlines) {
  EvidenceCount count(templ, camera, vertices_m);
  if (matches) return count.of(*matches);
  return sightlines ? count.of(*sightlines) : ShapeEvidence{};
}

/// A filter may know of a likelier place for the object, such as a copy of it: what it said, or 1.
inline double confidence_of_filters(const std::optional<Correspondences>& matches) {
  if (!matches || !matches->confidence.present()) return 1.0;
  return std::clamp(*matches->confidence.data(), 0.0, 1.0);
}

/// 1 / (1 + exp(-logit))
inline double logistic(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

}  // namespace weft
