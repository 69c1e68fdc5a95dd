// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/report/drawing/drawing.hpp"
#include "lab/report/drawing/scale.hpp"
#include "lab/statistics/unknown.hpp"

namespace weft::lab {

/// A dot with its interval; unknown ones have no mark.
struct Estimate {
  double value = kUnknown;
  Interval interval = {};
  ColourName colour = "series-1";
  bool hollow = false;
};

/// A name, a remark at its right, and estimates on one line below both.
struct IntervalRow {
  std::string name;
  std::string remark;  ///< "2.40 mm, n 8"
  std::vector<Estimate> estimates;
};

/// Estimates below each other over one axis.
struct IntervalChart {
  std::string name;   ///< name of its files
  std::string title;  ///< one line that describes it
  std::string head;   ///< written above it; may be empty
  std::string axis;   ///< title of the axis, with its unit
  std::vector<IntervalRow> rows;
  double width_px = 400.0;
};

/// The domain of all rows of some charts, so that they can be compared.
Domain domain_of(const std::vector<IntervalChart>& charts, bool from_zero);

Drawing draw(const IntervalChart& chart, const Domain& domain);

/// Panels of equal width side by side, in rows of `columns`, as one drawing.
Drawing in_a_grid(const std::vector<Drawing>& panels, std::size_t columns);

}  // namespace weft::lab
