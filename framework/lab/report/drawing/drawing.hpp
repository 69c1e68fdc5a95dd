// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <variant>
#include <vector>

/// Figures as marks, which become SVG within a page, an SVG file, or PGF for LaTeX.
namespace weft::lab {

/// [px] from the upper left.
struct PlacePx {
  double x = 0.0, y = 0.0;
};

/// A colour by its name in framework/web/src/tokens.css: "ink", "muted", "rule", "series-1", ...
using ColourName = const char*;

struct LineMark {
  std::vector<PlacePx> points;
  ColourName colour = "ink";
  double width_px = 1.0;
  bool dashed = false;
};

/// A closed outline, filled.
struct AreaMark {
  std::vector<PlacePx> points;
  ColourName colour = "ink";
  double opacity = 1.0;
};

struct DotMark {
  PlacePx centre;
  double radius_px = 4.0;
  ColourName colour = "ink";
  bool hollow = false;
  std::string tip = {};  ///< shown by a page where the pointer is over it
};

enum class Anchor { start, middle, end };

/// One line of text, whose baseline begins, is centred or ends at a place.
struct TextMark {
  PlacePx place;
  std::string text;
  Anchor anchor = Anchor::start;
  ColourName colour = "ink";
  double size_px = 12.0;
  bool bold = false;
};

using Mark = std::variant<LineMark, AreaMark, DotMark, TextMark>;

struct Drawing {
  std::string name;   ///< name of its files, "ranking-filter"
  std::string title;  ///< one line that describes it
  double width_px = 0.0, height_px = 0.0;
  std::vector<Mark> marks;  ///< later ones cover earlier ones
};

/// About the width of a text.
double text_width_px(const std::string& text, double size_px = 12.0);
/// The text, or its beginning and "…" if it is wider.
std::string shortened(const std::string& text, double width_px);

/// An element of a page, in the colours of the page's theme.
std::string to_svg_element(const Drawing& drawing);
/// A file with its origin, in the colours of the light theme on no background.
std::string to_svg_file(const Drawing& drawing, const std::string& origin);
/// A file for \input in LaTeX, which needs the package pgf; texts are in the document's font.
std::string to_pgf(const Drawing& drawing, const std::string& origin);

}  // namespace weft::lab
