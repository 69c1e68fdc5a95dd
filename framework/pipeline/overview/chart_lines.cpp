// SPDX-License-Identifier: Apache-2.0
#include "pipeline/overview/chart_lines.hpp"

#include <algorithm>
#include <cstdio>

namespace weft {

std::size_t ChartLine::reach() const {
  std::size_t reach = output.value_or(0);
  for (const WiringChart::Input& input : reads) reach = std::max(reach, input.value);
  return reach;
}

const WiringChart::Input* ChartLine::read_of(std::size_t column) const {
  const auto found = std::find_if(reads.begin(), reads.end(), [&](const WiringChart::Input& input) {
    return input.value == column;
  });
  return found != reads.end() ? &*found : nullptr;
}

std::vector<ChartLine> lines_of(const WiringChart& chart) {
  std::vector<ChartLine> lines;
  const std::size_t columns = chart.values.size();
  for (std::size_t row = 0; row < chart.rows.size(); ++row) {
    const WiringChart::Row& drawn = chart.rows[row];
    const std::size_t first = lines.size();
    const auto add = [&](std::optional<std::size_t> output) {
      ChartLine line{row, lines.size() == first, {}, output, std::vector<bool>(columns)};
      for (std::size_t column = 0; column < columns; ++column) {
        const WiringChart::Value& value = chart.values[column];
        const bool has_begun = value.maker < row || (value.maker == row && column < output);
        line.is_open[column] = has_begun && value.last_reader + (output ? 0 : 1) > row;
      }
      if (!output) line.reads = drawn.inputs;
      lines.push_back(std::move(line));
    };
    if (!drawn.inputs.empty() || drawn.outputs.empty()) add(std::nullopt);
    for (const std::size_t output : drawn.outputs) add(output);
  }
  return lines;
}

std::string milliseconds(double ms) {
  char text[32];
  std::snprintf(text, sizeof text, ms < 10.0 ? "%.2f ms" : "%.1f ms", ms);
  return text;
}

}  // namespace weft
