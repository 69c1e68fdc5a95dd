// SPDX-License-Identifier: Apache-2.0
#include "alignment.hpp"

#include <cmath>

#include "common/view/beside.hpp"

namespace weft::refine {
namespace {

// Residuals of neighbouring pixels resemble each other: three know as much as one would alone.
constexpr double kPixelsAlike = 3.0;

bool is_inside(const Eigen::Vector2d& place_px, const view::Picture& image) {
  return place_px.x() >= 0.0 && place_px.y() >= 0.0 && place_px.x() < image.width &&
         place_px.y() < image.height;
}

}  // namespace

Refinement refine(const view::PredictedView& view, const view::Picture& image,
                  const Eigen::Vector2d& expected_px, const Eigen::Vector2d& seen_px,
                  const RefineOptions& options) {
  Refinement refinement;
  if (!is_inside(expected_px, image) || !is_inside(seen_px, image)) return refinement;
  const int x = static_cast<int>(std::lround(expected_px.x())) - view::Patch::kSide / 2;
  const int y = static_cast<int>(std::lround(expected_px.y())) - view::Patch::kSide / 2;
  view::Patch patch;
  const view::Patch::Fit fit = view::take_beside([&](const view::Aside& aside) {
    return patch.take(view.level(0), x + aside.dx, y + aside.dy);
  });
  if (fit == view::Patch::Fit::not_drawn) return refinement;
  refinement.fate = Fate::flat;
  if (fit == view::Patch::Fit::flat) return refinement;
  const Eigen::Vector2f begin_px = (seen_px - expected_px).cast<float>();
  // As far as a step may be along both axes, and a little more for a way that is not straight.
  const auto reach_px = static_cast<float>(options.max_step_px + 1.0);
  const view::Alignment found = patch.find_in(image, begin_px.x(), begin_px.y(), reach_px);
  refinement.fate = Fate::unlike;
  if (found.end != view::Alignment::End::converged) return refinement;
  if (static_cast<double>(found.correlation) < options.min_correlation) return refinement;
  refinement.seen_px = expected_px + Eigen::Vector2d(found.dx, found.dy);
  refinement.fate =
      (refinement.seen_px - seen_px).norm() > options.max_step_px ? Fate::far : Fate::refined;
  refinement.covariance_px2 = kPixelsAlike * patch.covariance_px2(found.correlation);
  return refinement;
}

}  // namespace weft::refine
