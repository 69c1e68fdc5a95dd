// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/paper/paper.hpp"
#include "report/text/text_table.hpp"

namespace weft::evaluation {
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

double end_of(const Combination& combination) {
  const double high = combination.interval_mm.high;
  return std::isnan(high) ? combination.mean_mm : std::max(high, combination.mean_mm);
}

std::string row_svg(const Combination& combination, double y, double left, double px_per_mm) {
  const auto at = [&](double mm) { return left + px_per_mm * mm; };
  std::string text = fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                                 left - 8.0, y + 4.0, html_escaped(combination.name));
  const Interval& interval = combination.interval_mm;
  if (!std::isnan(interval.low)) {
    text += fmt::format(
        "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#0b6bb3\" "
        "stroke-width=\"2\"/>\n",
        at(interval.low), at(interval.high), y, y);
  }
  return text + fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"#0b6bb3\"/>\n",
                            at(combination.mean_mm), y);
}

}  // namespace

std::string error_figure(const Results& results, const ReportTables& tables) {
  std::vector<const Combination*> rows;
  double largest_mm = 0.0;
  std::size_t longest = 0;
  for (const Combination& combination : tables.combinations) {
    if (!std::isfinite(combination.mean_mm)) continue;
    rows.push_back(&combination);
    largest_mm = std::max(largest_mm, end_of(combination));
    longest = std::max(longest, combination.name.size());
  }
  if (rows.empty() || !(largest_mm > 0.0)) return "";
  const double step = tick_step(largest_mm), end_mm = std::ceil(largest_mm / step) * step;
  const double left = kMarginPx + kCharacterPx * static_cast<double>(longest) + 8.0;
  const double bottom = kMarginPx + kRowPx * static_cast<double>(rows.size());
  const double px_per_mm = kPlotPx / end_mm;
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 "
      "0 "
      "{0:.0f} {1:.0f}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\">\n"
      "<desc>{2}</desc>\n",
      left + kPlotPx + 2.0 * kMarginPx, bottom + kFootPx, html_escaped(origin_of(results)));
  const auto ticks = static_cast<int>(std::lround(end_mm / step));
  for (int i = 0; i <= ticks; ++i) {
    const double mm = step * i;
    const double x = left + px_per_mm * mm;
    text += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"#dddddd\"/>\n"
        "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4:.4g}</text>\n",
        x, kMarginPx, bottom, bottom + 16.0, mm);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = kMarginPx + kRowPx * (static_cast<double>(i) + 0.5);
    text += row_svg(*rows[i], y, left, px_per_mm);
  }
  return text + fmt::format(
                    "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">mean 3D error, mm, and "
                    "its 95 % interval</text>\n</svg>\n",
                    left + kPlotPx / 2.0, bottom + 34.0);
}

}  // namespace weft::evaluation
