// SPDX-License-Identifier: Apache-2.0
#include "lab/report/drawing/drawing.hpp"

#include <fmt/format.h>

#include <functional>
#include <utility>

#include "lab/report/drawing/colours.hpp"
#include "lab/report/text/text_table.hpp"

namespace weft::lab {
namespace {

/// How a colour is written, "var(--ink)" or "#1d1f21".
using Paint = std::function<std::string(ColourName)>;

std::string path_of(const std::vector<PlacePx>& points) {
  std::string path;
  for (const PlacePx& point : points) {
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", point.x, point.y);
  }
  return path;
}

std::string svg_of(const LineMark& line, const Paint& paint) {
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:.3g}\"{}/>\n",
                     path_of(line.points), paint(line.colour), line.width_px,
                     line.dashed ? " stroke-dasharray=\"3 3\"" : "");
}

std::string svg_of(const AreaMark& area, const Paint& paint) {
  return fmt::format("<path d=\"{}Z\" fill=\"{}\" fill-opacity=\"{:.3g}\"/>\n",
                     path_of(area.points), paint(area.colour), area.opacity);
}

std::string svg_of(const DotMark& dot, const Paint& paint) {
  const std::string colour = paint(dot.colour);
  const std::string tip = dot.tip.empty() ? "" : "<title>" + html_escaped(dot.tip) + "</title>";
  return fmt::format(
      "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.3g}\" fill=\"{}\" stroke=\"{}\" "
      "stroke-width=\"1.5\">{}</circle>\n",
      dot.centre.x, dot.centre.y, dot.radius_px, dot.hollow ? paint("paper") : colour, colour, tip);
}

std::string svg_of(const TextMark& text, const Paint& paint) {
  constexpr const char* kAnchors[] = {"start", "middle", "end"};
  return fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" fill=\"{}\" font-size=\"{:.3g}\"{}>{}"
      "</text>\n",
      text.place.x, text.place.y, kAnchors[static_cast<int>(text.anchor)], paint(text.colour),
      text.size_px, text.bold ? " font-weight=\"600\"" : "", html_escaped(text.text));
}

std::string body_of(const Drawing& drawing, const Paint& paint) {
  std::string text;
  for (const Mark& mark : drawing.marks) {
    text += std::visit([&](const auto& one) { return svg_of(one, paint); }, mark);
  }
  return text;
}

std::string size_of(const Drawing& drawing) {
  return fmt::format("width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\"",
                     drawing.width_px, drawing.height_px);
}

}  // namespace

double text_width_px(const std::string& text, double size_px) {
  constexpr double kShareOfSize = 0.54;
  std::size_t characters = 0;
  for (const char c : text) characters += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0;
  return kShareOfSize * size_px * static_cast<double>(characters);
}

std::string shortened(const std::string& text, double width_px) {
  std::string part = text;
  while (!part.empty() && text_width_px(part == text ? text : part + "…") > width_px) {
    do {
      const bool continues = (static_cast<unsigned char>(part.back()) & 0xC0U) == 0x80U;
      part.pop_back();
      if (!continues) break;
    } while (!part.empty());
  }
  return part == text ? text : part + "…";
}

std::string to_svg_element(const Drawing& drawing) {
  return fmt::format("<svg {} role=\"img\" aria-label=\"{}\">\n{}</svg>\n", size_of(drawing),
                     html_escaped(drawing.title), body_of(drawing, [](ColourName name) {
                       return fmt::format("var(--{})", name);
                     }));
}

std::string to_svg_file(const Drawing& drawing, const std::string& origin) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" {} font-family=\"Helvetica, Arial, "
      "sans-serif\">\n<title>{}</title>\n<desc>{}</desc>\n{}</svg>\n",
      size_of(drawing), html_escaped(drawing.title), html_escaped(origin),
      body_of(drawing, [](ColourName name) { return "#" + rgb_of(name); }));
}

}  // namespace weft::lab
