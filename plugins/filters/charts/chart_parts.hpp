// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/sdk/filter.hpp>

namespace weft::charts {

/// The charts of a template's texture: the parts of its mesh that are connected by vertex index.
class ChartParts {
 public:
  /// Finds the charts. The result is kept while the template's revision stays.
  void update(const Template& templ);

  int count() const { return static_cast<int>(charts_.size()); }

  /// The chart of a face; -1 for an index outside the template.
  int of_face(std::int32_t face) const {
    if (face < 0 || face >= static_cast<std::int64_t>(chart_of_face_.size())) return -1;
    return chart_of_face_[static_cast<std::size_t>(face)];
  }

  /// The inputs of a filter for one chart and its matches `rows`. The template is the chart alone,
  /// with a window of the texture and of the mask, and its own revision.
  FilterInput part(const FilterInput& in, int chart, const std::vector<std::int64_t>& rows) const;

 private:
  /// A chart: its mesh and its window of the texture, from pixel (left, top).
  struct Chart {
    std::vector<std::int32_t> vertices, faces;  ///< [.] indices in the template, ascending
    std::int64_t left = 0, top = 0, width = 1, height = 1;  ///< [] px of the texture
  };

  void connect(const Template& templ);
  static void find_window(const Template& templ, Chart& chart);
  Template template_of(const Template& templ, int chart) const;
  Correspondences matches_of(const Correspondences& matches, int chart,
                             const std::vector<std::int64_t>& rows) const;

  std::uint64_t revision_ = 0;  ///< [] of the template; 0 keeps nothing
  std::vector<Chart> charts_;
  std::vector<int> chart_of_face_;             ///< [F]
  std::vector<std::int32_t> face_in_chart_;    ///< [F] index of the face in its chart
  std::vector<std::int32_t> vertex_in_chart_;  ///< [V] likewise; 0 for a vertex without face
};

}  // namespace weft::charts
