// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <string>

#include "pipeline/overview/chart_lines.hpp"
#include "pipeline/overview/drawing.hpp"

namespace weft {
namespace {

// Lengths in pixels.
constexpr double kMargin = 12, kLine = 22, kGap = 10, kColumn = 22, kTimeWidth = 80;
constexpr double kLetter = 7.5;  // widest mean of a name's letters
constexpr const char* kColours[] = {"#2f7ed8", "#d9822b", "#2a9d61",
                                    "#8e5bc5", "#c9475f", "#1c8c95"};

constexpr const char* kStyle =
    "<style>\n"
    "text { font: 13px sans-serif; fill: #1b1f24; dominant-baseline: middle; }\n"
    ".id { font: 12px monospace; fill: #57606a; }\n"
    ".time { font-size: 12px; text-anchor: end; }\n"
    ".box { fill: #f3f5f7; stroke: #c3cad2; }\n"
    ".share { fill: #9fb8d8; }\n"
    ".line { fill: none; stroke: #8b949e; stroke-width: 1.5; }\n"
    ".ground { fill: #ffffff; }\n"
    "@media (prefers-color-scheme: dark) {\n"
    "text { fill: #e6e9ed; } .id { fill: #9aa4af; }\n"
    ".box { fill: #22272e; stroke: #444c56; } .share { fill: #3d5a80; }\n"
    ".ground { fill: #14181d; } }\n"
    "</style>\n";

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string text_at(double x, double y, const char* kind, const std::string& text) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" class=\"" + kind + "\">" + text +
         "</text>\n";
}

class Svg {
 public:
  explicit Svg(const WiringChart& chart) : chart_(chart), lines_(lines_of(chart)) {
    double y = kMargin;
    for (const ChartLine& line : lines_) {
      if (line.is_first && &line != &lines_.front()) y += kGap;
      ys_.push_back(y + kLine / 2);
      y += kLine;
    }
    height_ = y + kMargin;
    std::size_t name_letters = 0, id_letters = 0;
    for (const WiringChart::Row& row : chart.rows) {
      most_ms_ = std::max(most_ms_, row.ms.value_or(0));
      name_letters = std::max(name_letters, row.name.size());
      id_letters = std::max(id_letters, row.id.size());
    }
    id_x_ = kMargin + 10 + kLetter * static_cast<double>(name_letters) + 12;
    const double id_end = id_x_ + kLetter * static_cast<double>(id_letters);
    box_end_ = id_end + (most_ms_ > 0 ? kTimeWidth : kMargin);
  }

  std::string text() const {
    std::string columns, marks, boxes;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (lines_[i].is_first) boxes += box(i);
      marks += marks_of(i);
      if (lines_[i].output) columns += column(i);
    }
    const std::string size = "width=\"" + number(width()) + "\" height=\"" + number(height_) + "\"";
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" " + size + " viewBox=\"0 0 " +
           number(width()) + " " + number(height_) + "\">\n" + kStyle + "<rect class=\"ground\" " +
           size + "/>\n" + columns + marks + boxes + "</svg>\n";
  }

 private:
  double x_of(std::size_t column) const {
    return box_end_ + 34 + kColumn * static_cast<double>(column);
  }
  static const char* colour_of(std::size_t column) {
    return kColours[column % std::size(kColours)];
  }

  /// Wide enough for the names of all values.
  double width() const {
    double width = box_end_;
    for (std::size_t i = 0; i < chart_.values.size(); ++i) {
      const auto letters = static_cast<double>(chart_.values[i].type.size());
      width = std::max(width, x_of(i) + 12 + kLetter * letters);
    }
    return width + kMargin;
  }

  std::string box(std::size_t first) const {
    const WiringChart::Row& row = chart_.rows[lines_[first].row];
    std::size_t last = first;
    while (last + 1 < lines_.size() && !lines_[last + 1].is_first) ++last;
    const double top = ys_[first] - kLine / 2, bottom = ys_[last] + kLine / 2;
    const auto rect = [&](const char* kind, double y, double width, double height) {
      return std::string("<rect class=\"") + kind + "\" x=\"" + number(kMargin) + "\" y=\"" +
             number(y) + "\" width=\"" + number(width) + "\" height=\"" + number(height) +
             "\" rx=\"" + (height < 5 ? "1" : "5") + "\"/>\n";
    };
    std::string text = rect("box", top - 3, box_end_ - kMargin, bottom - top + 6);
    text += text_at(kMargin + 10, ys_[first], "name", row.name);
    text += text_at(id_x_, ys_[first], "id", row.id);
    if (!row.ms) return text;
    if (most_ms_ > 0) text += rect("share", bottom, (box_end_ - kMargin) * *row.ms / most_ms_, 3);
    return text + text_at(box_end_ - 8, ys_[first], "time", milliseconds(*row.ms));
  }

  /// The column of the value that a line makes, down to its last reader.
  std::string column(std::size_t made) const {
    const std::size_t value = *lines_[made].output;
    std::size_t end = made;
    while (end + 1 < lines_.size() && lines_[end + 1].is_open[value]) ++end;
    if (end == made) return "";
    return "<line class=\"line\" style=\"stroke:" + std::string(colour_of(value)) + "\" x1=\"" +
           number(x_of(value)) + "\" x2=\"" + number(x_of(value)) + "\" y1=\"" + number(ys_[made]) +
           "\" y2=\"" + number(ys_[end]) + "\"/>\n";
  }

  /// The line from a component to its marks, with an arrow into it where it reads.
  std::string marks_of(std::size_t index) const {
    const ChartLine& line = lines_[index];
    if (line.reads.empty() && !line.output) return "";
    const double y = ys_[index], edge = box_end_;
    std::string text = "<line class=\"line\" x1=\"" + number(edge) + "\" x2=\"" +
                       number(x_of(line.reach())) + "\" y1=\"" + number(y) + "\" y2=\"" +
                       number(y) + "\"/>\n";
    if (!line.output) {
      text += "<path class=\"line\" d=\"M" + number(edge + 9) + " " + number(y - 5) + "L" +
              number(edge + 2) + " " + number(y) + "L" + number(edge + 9) + " " + number(y + 5) +
              "\"/>\n";
    }
    for (const WiringChart::Input& input : line.reads) text += mark(input.value, y, input.required);
    if (!line.output) return text;
    return text + mark(*line.output, y, true) +
           text_at(x_of(*line.output) + 10, y, "type", chart_.values[*line.output].type);
  }

  std::string mark(std::size_t column, double y, bool is_filled) const {
    const std::string colour = colour_of(column);
    return "<circle cx=\"" + number(x_of(column)) + "\" cy=\"" + number(y) + "\" r=\"4\" " +
           (is_filled ? "fill=\"" + colour + "\"" : std::string("class=\"ground\"")) +
           " stroke=\"" + colour + "\" stroke-width=\"1.5\"/>\n";
  }

  const WiringChart& chart_;
  std::vector<ChartLine> lines_;
  std::vector<double> ys_;  ///< middle of each line
  double height_ = 0, most_ms_ = 0, id_x_ = 0, box_end_ = 0;
};

}  // namespace

std::string chart_svg(const WiringChart& chart) { return Svg(chart).text(); }

}  // namespace weft
