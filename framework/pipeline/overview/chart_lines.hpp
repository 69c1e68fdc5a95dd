// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/overview/wiring_chart.hpp"

namespace weft {

/// A line of a chart: a row has one for its inputs, if any, and one for each output. It
/// begins at the row's component and crosses the columns up to its last mark.
struct ChartLine {
  std::size_t row = 0;
  bool is_first = false;                  ///< the first line of its row
  std::vector<WiringChart::Input> reads;  ///< marks of a line of inputs
  std::optional<std::size_t> output;      ///< the value whose column begins here
  std::vector<bool> is_open;              ///< by column: it passes this line

  /// The column of the last mark.
  std::size_t reach() const;
  /// The input in a column, or null.
  const WiringChart::Input* read_of(std::size_t column) const;
};

std::vector<ChartLine> lines_of(const WiringChart& chart);

/// "0.43 ms", "12.4 ms".
std::string milliseconds(double ms);

}  // namespace weft
