// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <set>
#include <sstream>

#include "lab/report/drawing/colours.hpp"
#include "lab/report/text/latex.hpp"

namespace weft::lab {
namespace {

constexpr double kPtPerPx = 0.75;

/// Writes the marks of a drawing; PGF counts upwards from the lower left.
class PgfWriter {
 public:
  explicit PgfWriter(double height_px) : height_px_(height_px) {}

  void operator()(const LineMark& line) {
    add_path(line.points);
    text_ += fmt::format("\\pgfsetlinewidth{{{:.2f}pt}}\\pgfsetstrokecolor{{{}}}",
                         kPtPerPx * line.width_px, colour(line.colour));
    text_ += line.dashed ? "\\pgfsetdash{{2pt}{2pt}}{0pt}" : "\\pgfsetdash{}{0pt}";
    text_ += "\\pgfusepath{stroke}\n";
  }

  void operator()(const AreaMark& area) {
    add_path(area.points);
    text_ += fmt::format(
        "\\pgfpathclose\\pgfsetfillcolor{{{}}}\\pgfsetfillopacity{{{:.2f}}}"
        "\\pgfusepath{{fill}}\\pgfsetfillopacity{{1}}\n",
        colour(area.colour), area.opacity);
  }

  void operator()(const DotMark& dot) {
    text_ += fmt::format(
        "\\pgfpathcircle{{{}}}{{{:.2f}pt}}\\pgfsetlinewidth{{1pt}}\\pgfsetdash{{}}{{0pt}}"
        "\\pgfsetstrokecolor{{{}}}\\pgfsetfillcolor{{{}}}\\pgfusepath{{fill,stroke}}\n",
        point(dot.centre), kPtPerPx * dot.radius_px, colour(dot.colour),
        dot.hollow ? "white" : colour(dot.colour));
  }

  void operator()(const TextMark& text) {
    constexpr const char* kAnchors[] = {"left,base", "base", "right,base"};
    const std::string size =
        fmt::format("\\fontsize{{{0:.1f}}}{{{0:.1f}}}\\selectfont ", kPtPerPx * text.size_px);
    text_ += fmt::format("\\pgftext[at={},{}]{{{}\\color{{{}}}{}{}}}\n", point(text.place),
                         kAnchors[static_cast<int>(text.anchor)], size, colour(text.colour),
                         text.bold ? "\\bfseries " : "", latex_escaped(text.text));
  }

  std::string finish(const Drawing& drawing) const {
    std::string colours;
    for (const std::string& name : used_) {
      const std::string rgb = rgb_of(name.c_str());
      const auto share = [&](std::size_t at) {
        return std::stoi(rgb.substr(at, 2), nullptr, 16) / 255.0;
      };
      colours += fmt::format("\\definecolor{{weft-{}}}{{rgb}}{{{:.3f},{:.3f},{:.3f}}}\n", name,
                             share(0), share(2), share(4));
    }
    return fmt::format(
        "\\begin{{pgfpicture}}\n\\pgfpathrectangle{{\\pgfpointorigin}}{{\\pgfpoint{{{:.2f}pt}}"
        "{{{:.2f}pt}}}}\\pgfusepath{{use as bounding box}}\n{}{}\\end{{pgfpicture}}\n",
        kPtPerPx * drawing.width_px, kPtPerPx * drawing.height_px, colours, text_);
  }

 private:
  std::string point(const PlacePx& place) const {
    return fmt::format("\\pgfpoint{{{:.2f}pt}}{{{:.2f}pt}}", kPtPerPx * place.x,
                       kPtPerPx * (height_px_ - place.y));
  }

  std::string colour(ColourName name) {
    used_.insert(name);
    return fmt::format("weft-{}", name);
  }

  void add_path(const std::vector<PlacePx>& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      text_ +=
          fmt::format("{}{{{}}}", i == 0 ? "\\pgfpathmoveto" : "\\pgfpathlineto", point(points[i]));
    }
  }

  double height_px_;
  std::string text_;
  std::set<std::string> used_;
};

}  // namespace

std::string to_pgf(const Drawing& drawing, const std::string& origin) {
  PgfWriter writer(drawing.height_px);
  for (const Mark& mark : drawing.marks) std::visit(writer, mark);
  return latex_comment(drawing.title + "\n" + origin) + writer.finish(drawing);
}

}  // namespace weft::lab
