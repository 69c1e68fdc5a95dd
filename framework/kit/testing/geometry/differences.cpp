// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

#include "kit/testing/geometry/answers.hpp"

namespace weft::testing {
namespace {

// The tolerance that docs/conventions.md promises across compilers, whose rounding differs like
// that of a moved scene.
constexpr double kSame_m = 1e-6;
constexpr double kSame_px = 1e-6;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", value);
  return text;
}

std::string flags_moved(const Array<std::uint8_t>& before, const Array<std::uint8_t>& after,
                        const std::string& what, const auto& old_row) {
  std::int64_t differ = 0;
  for (std::int64_t i = 0; i < after.rows(); ++i) differ += after(i) != before(old_row(i)) ? 1 : 0;
  if (differ == 0) return "";
  return what + " of " + std::to_string(differ) + " of " + std::to_string(after.rows()) + " differ";
}

/// Places in the image with the points of the texture or of space that are seen there.
struct Sights {
  Points3 from;
  Points2 at_px;
};

/// Compares two sets of sights in any order.
std::string sights_moved(const Sights& expected, const Sights& made, double same_from,
                         double same_px) {
  if (expected.at_px.rows() != made.at_px.rows()) {
    return std::to_string(made.at_px.rows()) + ", not " + std::to_string(expected.at_px.rows());
  }
  std::int64_t missing = 0;
  for (Eigen::Index i = 0; i < expected.at_px.rows(); ++i) {
    const Eigen::ArrayXd off_px = (made.at_px.rowwise() - expected.at_px.row(i)).rowwise().norm();
    const Eigen::ArrayXd off = (made.from.rowwise() - expected.from.row(i)).rowwise().norm();
    missing += ((off_px <= same_px) && (off <= same_from)).any() ? 0 : 1;
  }
  if (missing == 0) return "";
  return std::to_string(missing) + " of " + std::to_string(expected.at_px.rows()) + " differ";
}

Sights sights_of(const Correspondences& matches) {
  Points3 from = Points3::Zero(matches.count(), 3);
  from.leftCols<2>() = matches.template_px.matrix<2>();
  return {from, matches.image_px.matrix<2>()};
}

/// Points of the template at rest, of the sightlines.
Sights sights_of(const Sightlines& lines, const Template& templ) {
  Sights sights{Points3::Zero(lines.count(), 3), lines.pixel_px.matrix<2>()};
  const auto vertices_m = templ.vertices_m.matrix<3>();
  for (std::int64_t i = 0; i < lines.count(); ++i) {
    if (lines.vertex(i) >= 0) {
      sights.from.row(i) = vertices_m.row(lines.vertex(i));
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      sights.from.row(i) +=
          lines.barycentrics(i, k) * vertices_m.row(templ.faces(lines.face(i), k));
    }
  }
  return sights;
}

/// Only pixels beside the border of what is marked may differ, by the rounding of pixels.
std::string region_moved(const Region& before, const Region& after, const Move& move) {
  const auto is_set = [](const Region& region, double x, double y) {
    const std::int64_t column = std::llround(x), row = std::llround(y);
    const bool inside =
        column >= 0 && row >= 0 && column < region.mask.dim(1) && row < region.mask.dim(0);
    return inside && region.mask(row, column) != 0;
  };
  const Eigen::Matrix2d back = move.image.inverse();
  std::int64_t differ = 0;
  for (std::int64_t y = 0; y < after.mask.dim(0); ++y) {
    for (std::int64_t x = 0; x < after.mask.dim(1); ++x) {
      const Eigen::Vector2d place(static_cast<double>(x), static_cast<double>(y));
      const Eigen::Vector2d from = back * (place - move.image_shift_px);
      const bool old = is_set(before, from.x(), from.y());
      bool beside_border = false;
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        beside_border = beside_border || is_set(before, from.x() + dx, from.y() + dy) != old;
      }
      const bool now = after.mask(y, x) != 0;
      differ += now != old && !beside_border ? 1 : 0;
    }
  }
  return differ == 0 ? "" : "its region differs in " + std::to_string(differ) + " pixels";
}

/// How sure a component is may follow from errors in pixels, compared with those of usual images.
bool judged_alike(const Move& move) { return move.pixels() == 1.0; }

std::string shape_moved(const Shape& before, const Shape& after, const Move& move) {
  const Points3 expected_m = move.in_space(before.vertices_m.matrix<3>());
  double worst_m = 0.0;
  for (std::int64_t v = 0; v < after.vertices_m.rows(); ++v) {
    const auto made_m = after.vertices_m.matrix<3>().row(v);
    worst_m = std::max(worst_m, (made_m - expected_m.row(move.vertex(v))).norm());
  }
  if (!(worst_m <= kSame_m * move.metres)) {
    return "a vertex is off by " + number(1000.0 * worst_m) + " mm";
  }
  const bool same = !judged_alike(move) || after.state == before.state;
  return same ? "" : "the state of its shape differs";
}

std::string matches_moved(const Scene& scene, const Correspondences& before,
                          const Correspondences& after, const Move& move) {
  Correspondences expected = before;
  const Points2 texels_px = moved_texels(scene.templ, before.template_px.matrix<2>(), move);
  expected.template_px = make_array<double>(texels_px);
  expected.image_px = make_array<double>(move.in_image(before.image_px.matrix<2>()));
  const std::string how =
      sights_moved(sights_of(expected), sights_of(after), kSame_px, kSame_px * move.pixels());
  return how.empty() ? "" : "its matches: " + how;
}

std::string lines_moved(const Scene& scene, const Sightlines& before, const Sightlines& after,
                        const Move& move) {
  Sights expected = sights_of(before, scene.templ);
  const Template templ = moved(scene, move).templ;
  expected.from *= move.metres;
  if (move.mirrors_texture) {
    const double right_m = static_cast<double>(templ.texture.dim(1) - 1) * templ.m_per_px(0);
    expected.from.col(0) = right_m - expected.from.col(0).array();
  }
  expected.at_px = move.in_image(expected.at_px);
  const std::string how = sights_moved(expected, sights_of(after, templ), kSame_m * move.metres,
                                       kSame_px * move.pixels());
  return how.empty() ? "" : "its sightlines: " + how;
}

std::string warp_moved(const Asked& before, const Asked& after, const Move& move) {
  if (!before.warped_px || !after.warped_px) return "its warp cannot be evaluated";
  const Points2 off_px = *after.warped_px - move.in_image(*before.warped_px);
  const double worst_px = off_px.rowwise().norm().maxCoeff();
  if (worst_px <= kSame_px * move.pixels()) return "";
  return "its warp is off by " + number(worst_px) + " px";
}

}  // namespace

std::string difference_moved(const Scene& scene, const Asked& before, const Asked& after,
                             const Move& move) {
  const bool as_sure = !judged_alike(move) || before.answer.status == after.answer.status;
  if (!after.answer.is_usable() || !as_sure) {
    return "it reports " + to_text(after.answer) + ", not " + to_text(before.answer);
  }
  for (const auto& [slot, record] : before.answer.outputs) {
    const HostRecord other = after.answer.find(slot);
    if (other == nullptr) return "it makes no " + slot;
    std::string how;
    if (const auto was = typed_in<InlierMask>(record)) {
      how = flags_moved(was->kept, typed_in<InlierMask>(other)->kept, "verdicts",
                        [&](std::int64_t row) { return move.match(row); });
    } else if (const auto was_seen = typed_in<Visibility>(record)) {
      how = flags_moved(was_seen->visible, typed_in<Visibility>(other)->visible, "visibilities",
                        [&](std::int64_t row) { return move.vertex(row); });
    } else if (const auto was_matched = typed_in<Correspondences>(record)) {
      how = matches_moved(scene, *was_matched, *typed_in<Correspondences>(other), move);
    } else if (const auto was_lined = typed_in<Sightlines>(record)) {
      how = lines_moved(scene, *was_lined, *typed_in<Sightlines>(other), move);
    } else if (const auto was_marked = typed_in<Region>(record)) {
      how = region_moved(*was_marked, *typed_in<Region>(other), move);
    } else if (const auto was_shaped = typed_in<Shape>(record)) {
      how = shape_moved(*was_shaped, *typed_in<Shape>(other), move);
    } else if (typed_in<Warp>(record)) {
      how = warp_moved(before, after, move);
    }
    if (!how.empty()) return how;
  }
  return "";
}

}  // namespace weft::testing
