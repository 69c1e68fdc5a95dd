// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lab/report/drawing/drawing.hpp"

namespace weft::lab {

struct LineSeries {
  std::string name;
  ColourName colour = "series-1";
  std::vector<std::pair<double, double>> points;  ///< x, y; finite
};

/// Lines over one axis, with y from 0 upwards.
struct LineChart {
  std::string name;   ///< name of its files
  std::string title;  ///< one line that describes it
  std::string x_axis, y_axis;
  std::vector<LineSeries> series;
};

Drawing draw(const LineChart& chart);

}  // namespace weft::lab
