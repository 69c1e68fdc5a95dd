// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lab/report/paper/paper.hpp"
#include "lab/report/text/text_table.hpp"

namespace weft::lab {
namespace {

constexpr double kRowPx = 18.0, kPlotPx = 300.0, kCharacterPx = 6.4, kMarginPx = 12.0;
constexpr double kFootPx = 42.0;

/// 1, 2 or 5 times a power of ten, so that some four of them make up a length.
double tick_step(double length) {
  const double rough = length / 4.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= rough) return step * power;
  }
  return 10.0 * power;
}

constexpr const char *kBlue = "#0b6bb3", *kOrange = "#d1560a";

struct Dot {
  double value;
  Interval interval;
  const char* colour;
};

struct FigureRow {
  std::string name;
  std::vector<Dot> dots;
};

double end_of(const Dot& dot) {
  return std::isnan(dot.interval.high) ? dot.value : std::max(dot.interval.high, dot.value);
}

std::string row_svg(const FigureRow& row, double y, double left, double px_per_unit) {
  const auto at = [&](double value) { return left + px_per_unit * value; };
  std::string text = fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                                 left - 8.0, y + 4.0, html_escaped(row.name));
  for (const Dot& dot : row.dots) {
    if (!std::isnan(dot.interval.low)) {
      text += fmt::format(
          "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
          "stroke-width=\"2\"/>\n",
          at(dot.interval.low), at(dot.interval.high), y, y, dot.colour);
    }
    text += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>\n",
                        at(dot.value), y, dot.colour);
  }
  return text;
}

/// Rows of dots over an axis from 0; empty without a dot above it.
std::string dot_figure(const std::vector<FigureRow>& rows, const std::string& title,
                       const std::string& origin) {
  double largest = 0.0;
  std::size_t longest = 0;
  for (const FigureRow& row : rows) {
    for (const Dot& dot : row.dots) largest = std::max(largest, end_of(dot));
    longest = std::max(longest, row.name.size());
  }
  if (!(largest > 0.0)) return "";
  const double step = tick_step(largest), end = std::ceil(largest / step) * step;
  const double left = kMarginPx + kCharacterPx * static_cast<double>(longest) + 8.0;
  const double bottom = kMarginPx + kRowPx * static_cast<double>(rows.size());
  const double px_per_unit = kPlotPx / end;
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 "
      "0 "
      "{0:.0f} {1:.0f}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\">\n"
      "<desc>{2}</desc>\n",
      left + kPlotPx + 2.0 * kMarginPx, bottom + kFootPx, html_escaped(origin));
  const auto ticks = static_cast<int>(std::lround(end / step));
  for (int i = 0; i <= ticks; ++i) {
    const double value = step * i;
    const double x = left + px_per_unit * value;
    text += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"#dddddd\"/>\n"
        "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4:.4g}</text>\n",
        x, kMarginPx, bottom, bottom + 16.0, value);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = kMarginPx + kRowPx * (static_cast<double>(i) + 0.5);
    text += row_svg(rows[i], y, left, px_per_unit);
  }
  return text +
         fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n</svg>\n",
                     left + kPlotPx / 2.0, bottom + 34.0, title);
}

}  // namespace

std::string error_figure(const Results& results, const ReportTables& tables) {
  std::vector<FigureRow> rows;
  for (const Combination& each : tables.combinations) {
    if (!std::isfinite(each.mean_mm)) continue;
    rows.push_back({each.name, {{each.mean_mm, each.interval_mm, kBlue}}});
  }
  return dot_figure(rows, "mean 3D error, mm, and its 95 % interval", origin_of(results));
}

std::string filter_figure(const Results& results, const ReportTables& tables) {
  if (tables.filter_stages.empty()) return "";
  std::vector<FigureRow> rows;
  for (const Combination& each : tables.combinations) {
    const FilterRates* rates = each.filter(tables.filter_stages.back());
    if (rates == nullptr) continue;
    FigureRow row{each.name, {}};
    for (const auto& [percent, colour] :
         {std::pair(rates->tpr_percent, kBlue), std::pair(rates->precision_percent, kOrange)}) {
      if (std::isfinite(percent)) row.dots.push_back({percent, {}, colour});
    }
    rows.push_back(std::move(row));
  }
  return dot_figure(rows, "mismatches rejected (blue) and precision (orange), %",
                    origin_of(results));
}

}  // namespace weft::lab
