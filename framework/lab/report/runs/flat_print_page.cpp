// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <weft/core/base64.hpp>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

#include "lab/report/runs/flat_print.hpp"
#include "lab/report/text/text_table.hpp"

namespace weft::lab {
namespace {

enum class Mark : std::uint8_t { near, middle, far, missing };

struct MarkStyle {
  const char* name;     ///< class of its path
  const char* meaning;  ///< in the legend
};

constexpr std::array<MarkStyle, 4> kMarks{{{"near", "at most 1 mm"},
                                           {"middle", "at most 2 mm"},
                                           {"far", "more than 2 mm"},
                                           {"missing", "not found"}}};

/// The longest arrow is this part of the texture's longer side.
constexpr int kParts = 12;

double longer_px(const FlatPrint& print) {
  return static_cast<double>(std::max(print.width_px, print.height_px));
}

double length_mm(const PrintPatch& patch) { return std::hypot(patch.du_mm, patch.dv_mm); }

Mark mark_of(const PrintPatch& patch) {
  const double mm = length_mm(patch);
  if (std::isnan(mm)) return Mark::missing;
  if (mm > 2.0) return Mark::far;
  return mm <= 1.0 ? Mark::near : Mark::middle;
}

/// The factor by which arrows are enlarged: nine of ten are then at most as long as a part of the
/// texture.
int enlargement(const FlatPrint& print) {
  constexpr double kPart = 0.05;
  std::vector<double> lengths_mm;
  for (const PrintFrame& frame : print.frames) {
    for (const PrintPatch& patch : frame.patches) {
      if (mark_of(patch) != Mark::missing) lengths_mm.push_back(length_mm(patch));
    }
  }
  const double longest_mm =
      kPart * std::max(static_cast<double>(print.width_px) * print.mm_per_px_u,
                       static_cast<double>(print.height_px) * print.mm_per_px_v);
  int chosen = 1;
  for (const int times : {2, 5, 10, 20}) {
    if (times * percentile(lengths_mm, 90.0) <= longest_mm) chosen = times;
  }
  return chosen;
}

/// A cross for a patch that was not found, else an arrow, or a dot if the arrow would be too short.
/// Arrows to wrong places far away are cut, because only their direction matters.
std::string mark_path(const PrintPatch& patch, const FlatPrint& print, int times) {
  const double size_px = 0.008 * longer_px(print);
  const double u = patch.u_px, v = patch.v_px;
  if (mark_of(patch) == Mark::missing) {
    return fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}m{:.1f} 0l{:.1f} {:.1f}", u - size_px,
                       v - size_px, 2 * size_px, 2 * size_px, -2 * size_px, 2 * size_px,
                       -2 * size_px);
  }
  double du = times * patch.du_mm / print.mm_per_px_u;
  double dv = times * patch.dv_mm / print.mm_per_px_v;
  const double drawn = std::min(1.0, longer_px(print) / kParts / std::hypot(du, dv));
  du *= drawn;
  dv *= drawn;
  const double length_px = std::hypot(du, dv);
  if (length_px < 0.5 * size_px) {
    const double radius_px = 0.2 * size_px;
    return fmt::format(
        "M{0:.1f} {1:.1f}a{2:.1f} {2:.1f} 0 1 0 {3:.1f} 0a{2:.1f} {2:.1f} 0 1 0 {4:.1f} 0",
        u - radius_px, v, radius_px, 2 * radius_px, -2 * radius_px);
  }
  const std::string line = fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}", u, v, du, dv);
  const double barb = std::min(size_px, 0.5 * length_px) / length_px;
  // Barbs at 30 degrees: from their ends to the tip and back.
  constexpr double kAlong = 0.866, kAcross = 0.5;
  const double left_u = -barb * (kAlong * du - kAcross * dv);
  const double left_v = -barb * (kAlong * dv + kAcross * du);
  const double right_u = -barb * (kAlong * du + kAcross * dv);
  const double right_v = -barb * (kAlong * dv - kAcross * du);
  return line + fmt::format("m{:.1f} {:.1f}L{:.1f} {:.1f}l{:.1f} {:.1f}", left_u, left_v, u + du,
                            v + dv, right_u, right_v);
}

/// A group of at most four paths, each over a lighter one that separates it from the image.
std::string print_arrows(const PrintFrame& frame, const FlatPrint& print, int times) {
  std::array<std::string, kMarks.size()> paths;
  for (const PrintPatch& patch : frame.patches) {
    paths[to_index(mark_of(patch))] += mark_path(patch, print, times);
  }
  std::string text = fmt::format("<g id=\"arrows-{}\">", frame.frame);
  for (const char* layer : {"halo ", ""}) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (paths[i].empty()) continue;
      text += fmt::format("<path class=\"arrow {}{}\" d=\"{}\"/>", layer, kMarks[i].name, paths[i]);
    }
  }
  return text + "</g>";
}

std::string svg_image(const FlatPrint& print, const std::string& media_type,
                      const std::string& bytes, const char* id) {
  return fmt::format(
             "<image{} class=\"backdrop\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" "
             "href=\"data:{};base64,",
             id, print.width_px, print.height_px, media_type) +
         base64(bytes) + "\"/>";
}

std::string print_panel(const FlatPrint& print, const std::string& title,
                        const std::string& content) {
  return fmt::format(
             "<div class=\"view\"><svg viewBox=\"0 0 {} {}\" role=\"img\" "
             "aria-label=\"{}\">",
             print.width_px, print.height_px, title) +
         content + "</svg><span>" + title + "</span></div>\n";
}

std::string print_caption(const PrintFrame& frame, const RunMetrics& metrics) {
  const auto found = std::find_if(metrics.frames.begin(), metrics.frames.end(),
                                  [&](const auto& one) { return one.frame == frame.frame; });
  const FrameRegistration& figures = *found->registration;
  return fmt::format(
      "<figcaption>{} frame, {}: {} of {} patches within 1 mm, {} within 2 mm, "
      "{} not found; median {} mm</figcaption>",
      frame.rank, html_escaped(found->label()), figures.within_1mm, figures.patches,
      figures.within_2mm, figures.patches - figures.found, number_cell(figures.median_mm, 2).shown);
}

std::string mark_legend() {
  std::string text = "<ul class=\"legend\">";
  for (const MarkStyle& mark : kMarks) {
    const char* sign = &mark == &kMarks.back() ? "×" : "→";
    text +=
        fmt::format("<li><span class=\"sign {}\">{}</span>{}</li>", mark.name, sign, mark.meaning);
  }
  return text + "</ul>\n";
}

}  // namespace

std::string flat_print_html(const FlatPrint& print, const RunMetrics& metrics) {
  if (print.frames.empty()) return "";
  const int times = enlargement(print);
  std::string text = fmt::format(
      "<p>Each arrow leads from the place of a patch in the flat texture to where the unwarped "
      "image shows it. It is {}as long as the displacement, but at most 1/{} of the texture. "
      "Patches are words, or the cells of a grid. Frames are ranked by the patches within 1 "
      "mm.</p>\n",
      times > 1 ? fmt::format("{} times ", times) : "", kParts);
  text += mark_legend() + "<div class=\"print\">\n";
  for (const PrintFrame& frame : print.frames) {
    const bool is_first = &frame == &print.frames.front();
    text += fmt::format("<figure data-frame=\"{}\"><div class=\"views\">", frame.frame);
    text += print_panel(print, "flat print",
                        (is_first ? svg_image(print, "image/png", print.png, " id=\"flat-print\"")
                                  : "<use href=\"#flat-print\"/>") +
                            print_arrows(frame, print, times));
    if (!frame.unwarped.empty()) {
      text += print_panel(print, "unwarped image",
                          svg_image(print, frame.media_type, frame.unwarped, "") +
                              fmt::format("<use href=\"#arrows-{}\"/>", frame.frame));
    }
    text += "</div>" + print_caption(frame, metrics) + "</figure>\n";
  }
  return text + "</div>\n";
}

}  // namespace weft::lab
