// SPDX-License-Identifier: Apache-2.0
#include "lab/report/drawing/interval_chart.hpp"

#include <algorithm>
#include <cmath>

namespace weft::lab {
namespace {

constexpr double kMarginPx = 12.0;  // left and right of the axis
constexpr double kHeadPx = 22.0;
constexpr double kRowPx = 34.0;
constexpr double kNamePx = 13.0;   // baseline of a row's name below its upper end
constexpr double kDotPx = 24.0;    // its dots
constexpr double kAxisPx = 42.0;   // numbers and title of the axis
constexpr double kSmallPx = 11.0;  // size of small texts
constexpr double kGapPx = 24.0;    // between panels

/// Lines at the ticks, interrupted by the texts of the rows, and the numbers below.
void add_axis(const IntervalChart& chart, const Scale& scale, const Domain& domain, double top,
              Drawing& drawing) {
  const double bottom = top + kRowPx * static_cast<double>(chart.rows.size());
  double free_from = 0.0;
  for (const double tick : scale.ticks()) {
    const double x = scale.at(tick);
    const bool is_zero = tick == 0.0 && domain.low < 0.0;
    for (std::size_t i = 0; i < chart.rows.size(); ++i) {
      const double row = top + kRowPx * static_cast<double>(i);
      drawing.marks.push_back(LineMark{{{x, row + kNamePx + 4.0}, {x, row + kRowPx}},
                                       is_zero ? "rule-strong" : "rule"});
    }
    const std::string text = tick_text(tick);
    const double half = 0.5 * text_width_px(text, kSmallPx);
    if (x - half < free_from) continue;
    free_from = x + half + 6.0;
    drawing.marks.push_back(TextMark{{x, bottom + 14.0}, text, Anchor::middle, "muted", kSmallPx});
  }
  drawing.marks.push_back(TextMark{{kMarginPx, bottom + 32.0}, chart.axis});
}

void add_row(const IntervalRow& row, const Scale& scale, double top, Drawing& drawing) {
  const double remark_px = text_width_px(row.remark, kSmallPx);
  const double room_px = drawing.width_px - remark_px - 8.0;
  drawing.marks.push_back(TextMark{{0.0, top + kNamePx}, shortened(row.name, room_px)});
  if (!row.remark.empty()) {
    drawing.marks.push_back(
        TextMark{{drawing.width_px, top + kNamePx}, row.remark, Anchor::end, "muted", kSmallPx});
  }
  for (const Estimate& each : row.estimates) {
    const double y = top + kDotPx;
    if (std::isfinite(each.interval.low) && std::isfinite(each.interval.high)) {
      drawing.marks.push_back(LineMark{
          {{scale.at(each.interval.low), y}, {scale.at(each.interval.high), y}}, each.colour, 2.5});
    }
    if (!std::isfinite(each.value)) continue;
    drawing.marks.push_back(DotMark{{scale.at(each.value), y},
                                    4.0,
                                    each.colour,
                                    each.hollow,
                                    row.name + (row.remark.empty() ? "" : ": " + row.remark)});
  }
}

struct Shift {
  double x, y;

  void operator()(PlacePx& place) const { place = {place.x + x, place.y + y}; }
  void operator()(LineMark& line) const {
    std::for_each(line.points.begin(), line.points.end(), *this);
  }
  void operator()(AreaMark& area) const {
    std::for_each(area.points.begin(), area.points.end(), *this);
  }
  void operator()(DotMark& dot) const { (*this)(dot.centre); }
  void operator()(TextMark& text) const { (*this)(text.place); }
};

}  // namespace

Domain domain_of(const std::vector<IntervalChart>& charts, bool from_zero) {
  std::vector<double> values;
  for (const IntervalChart& chart : charts) {
    for (const IntervalRow& row : chart.rows) {
      for (const Estimate& each : row.estimates) {
        values.insert(values.end(), {each.value, each.interval.low, each.interval.high});
      }
    }
  }
  if (!from_zero) values.push_back(0.0);
  return domain_of(std::move(values), from_zero);
}

Drawing draw(const IntervalChart& chart, const Domain& domain) {
  const double top = chart.head.empty() ? 0.0 : kHeadPx;
  const double bottom = top + kRowPx * static_cast<double>(chart.rows.size());
  Drawing drawing{chart.name, chart.title, chart.width_px, bottom + kAxisPx, {}};
  const Scale scale(domain, kMarginPx, chart.width_px - kMarginPx);
  if (!chart.head.empty()) {
    drawing.marks.push_back(TextMark{
        {0.0, kNamePx}, shortened(chart.head, chart.width_px), Anchor::start, "ink", 12.5, true});
  }
  add_axis(chart, scale, domain, top, drawing);
  for (std::size_t i = 0; i < chart.rows.size(); ++i) {
    add_row(chart.rows[i], scale, top + kRowPx * static_cast<double>(i), drawing);
  }
  return drawing;
}

Drawing in_a_grid(const std::vector<Drawing>& panels, std::size_t columns) {
  if (panels.size() == 1) return panels.front();
  Drawing whole = panels.front();
  whole.marks.clear();
  whole.width_px = whole.height_px = 0.0;
  double y = 0.0;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const auto column = static_cast<double>(i % columns);
    if (i > 0 && i % columns == 0) y = whole.height_px + kGapPx;
    const Shift shift{column * (panels[i].width_px + kGapPx), y};
    for (Mark mark : panels[i].marks) {
      std::visit(shift, mark);
      whole.marks.push_back(std::move(mark));
    }
    whole.width_px = std::max(whole.width_px, shift.x + panels[i].width_px);
    whole.height_px = std::max(whole.height_px, y + panels[i].height_px);
  }
  return whole;
}

}  // namespace weft::lab
