// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>
#include <weft/data/template.hpp>
#include <weft/data/visibility.hpp>

#include "lab/metrics/field.hpp"
#include "lab/statistics/unknown.hpp"

namespace weft {
class TruthMap;
}

namespace weft::lab {

struct PointErrors;

/// One frame whose truth includes visibility. Positive is a visible vertex.
struct VisibilityCounts {
  std::int64_t seen_right = 0;                         ///< [] vertices, true positives
  std::int64_t seen_wrong = 0;                         ///< [] vertices, false positives
  std::int64_t hidden_right = 0;                       ///< [] vertices, true negatives
  std::int64_t hidden_wrong = 0;                       ///< [] vertices, false negatives
  std::int64_t visible_points = 0, hidden_points = 0;  ///< [] of the truth, with an error
  double visible_sum_mm = 0.0, hidden_sum_mm = 0.0;    ///< [] mm, sums of their errors

  std::int64_t vertices() const { return seen_right + seen_wrong + hidden_right + hidden_wrong; }
};

/// The same over a run. All vertices, and all points, count the same, regardless of their frames.
struct VisibilityMetrics {
  std::int64_t frames = 0;                             ///< [] frames whose truth includes
                                                       ///< visibility
  std::int64_t vertices = 0, hidden_vertices = 0;      ///< [] classified by the run; hidden in
                                                       ///< truth
  std::int64_t visible_points = 0, hidden_points = 0;  ///< [] true points by visibility
  double precision_percent = kUnknown;  ///< [] share of the vertices classified as visible that are
                                        ///< visible
  double recall_percent = kUnknown;     ///< [] share of the visible vertices that are classified as
                                        ///< visible
  double f1_percent = kUnknown;         ///< [] of seen vertices
  double hidden_f1_percent = kUnknown;  ///< [] of hidden vertices
  double visible_mm = kUnknown;         ///< [] mm, mean 3D error of points that are seen
  double hidden_mm = kUnknown;          ///< [] mm, and of those that are not

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"frames", "frames whose truth has visibility"}, self.frames);
    visit({"vertices", "vertices that a pass classified as visible or hidden"}, self.vertices);
    visit({"hidden_vertices", "of them, hidden in truth"}, self.hidden_vertices);
    visit({"precision_percent", "visible share of the vertices classified as visible", kHigher},
          self.precision_percent);
    visit({"recall_percent", "share of the visible vertices classified as visible", kHigher},
          self.recall_percent);
    visit({"f1_percent", "of seen vertices", kHigher}, self.f1_percent);
    visit({"hidden_f1_percent", "of hidden vertices", kHigher}, self.hidden_f1_percent);
    visit({"visible_points", "points of the truth that the camera sees, with an error"},
          self.visible_points);
    visit({"hidden_points", "and those that it does not see"}, self.hidden_points);
    visit({"visible_mm", "mean 3D error of points that are seen", kLower}, self.visible_mm);
    visit({"hidden_mm", "and of those that are not", kLower}, self.hidden_mm);
  }
};

/// Compares the visibility that a run reports for the template's vertices with the truth. A vertex
/// is truly visible if the camera sees a corner of the true face that contains it. Vertices outside
/// the true surface are omitted, and all of them on a template without m_per_px.
void count_vertices(const Visibility& said, const Template& sheet, const TruthMap& truth,
                    VisibilityCounts& counts);

/// Adds errors at points of the truth; `visible` [T] marks the visible ones.
void count_errors(const PointErrors& errors, const Array<std::uint8_t>& visible,
                  VisibilityCounts& counts);

VisibilityMetrics summarise_visibility(const std::vector<VisibilityCounts>& frames);

/// The same of a frame that may have none.
std::optional<VisibilityMetrics> visibility_of(const std::optional<VisibilityCounts>& frame);

}  // namespace weft::lab
