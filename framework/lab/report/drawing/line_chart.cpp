// SPDX-License-Identifier: Apache-2.0
#include "lab/report/drawing/line_chart.hpp"

#include <algorithm>

#include "lab/report/drawing/scale.hpp"

namespace weft::lab {
namespace {

constexpr double kWidthPx = 720.0, kHeightPx = 260.0;
constexpr double kLeftPx = 44.0, kRightPx = 12.0, kTopPx = 26.0, kBottomPx = 40.0;
constexpr double kNumberPx = 11.0;  // size of the numbers at the axes

}  // namespace

Drawing draw(const LineChart& chart) {
  std::vector<double> x, y;
  for (const LineSeries& series : chart.series) {
    for (const auto& point : series.points) {
      x.push_back(point.first);
      y.push_back(point.second);
    }
  }
  Drawing drawing{chart.name, chart.title, kWidthPx, kHeightPx, {}};
  if (x.empty()) return drawing;
  const auto [first, last] = std::minmax_element(x.begin(), x.end());
  const double bottom = kHeightPx - kBottomPx;
  const Scale across({*first, std::max(*last, *first + 1.0), false}, kLeftPx, kWidthPx - kRightPx);
  const Scale up(domain_of(y, true), bottom, kTopPx);
  for (const double tick : up.ticks()) {
    const double at = up.at(tick);
    drawing.marks.push_back(LineMark{{{kLeftPx, at}, {kWidthPx - kRightPx, at}}, "rule"});
    drawing.marks.push_back(
        TextMark{{kLeftPx - 6.0, at + 4.0}, tick_text(tick), Anchor::end, "muted", kNumberPx});
  }
  for (const double tick : across.ticks()) {
    drawing.marks.push_back(TextMark{
        {across.at(tick), bottom + 16.0}, tick_text(tick), Anchor::middle, "muted", kNumberPx});
  }
  drawing.marks.push_back(TextMark{{0.0, 12.0}, chart.y_axis});
  drawing.marks.push_back(
      TextMark{{kWidthPx - kRightPx, bottom + 34.0}, chart.x_axis, Anchor::end});
  double legend_px = kWidthPx - kRightPx;
  for (const LineSeries& series : chart.series) {
    LineMark line{{}, series.colour, 1.5};
    for (const auto& [px, py] : series.points) line.points.push_back({across.at(px), up.at(py)});
    drawing.marks.push_back(std::move(line));
    drawing.marks.push_back(
        TextMark{{legend_px, 12.0}, series.name, Anchor::end, series.colour, 12.0, true});
    legend_px -= text_width_px(series.name) + 16.0;
  }
  return drawing;
}

}  // namespace weft::lab
