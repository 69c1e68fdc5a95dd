// SPDX-License-Identifier: Apache-2.0
#include "kit/testing/geometry/bounds.hpp"

#include <cmath>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/face_locator.hpp>

namespace weft::testing {
namespace {

/// Where the true mesh shows these points of the texture.
Points2 true_pixels(const Scene& scene, const Points2View& texels_px) {
  const Faces faces = scene.templ.faces.matrix<3>();
  const Points3 vertices_m = scene.shape.vertices_m.matrix<3>();
  const auto locator = FaceLocator::create(scene.templ.flat_px.matrix<2>(), faces);
  if (!locator) throw std::logic_error(locator.error().message);
  Points2 pixels(texels_px.rows(), 2);
  for (Eigen::Index i = 0; i < texels_px.rows(); ++i) {
    const FaceLocation at = locator->locate(texels_px.row(i));
    pixels.row(i) =
        project(pinhole(scene.camera), interpolate(vertices_m, faces, at.face, at.weights))
            .transpose();
  }
  return pixels;
}

Deviation share(double wrong, std::int64_t count, const std::string& of_what) {
  const double part = count == 0 ? 1.0 : wrong / static_cast<double>(count);
  return {part, kShareBound,
          std::to_string(std::lround(wrong)) + " of " + std::to_string(count) + " " + of_what};
}

Deviation far_pixels(const Points2View& made_px, const Points2View& true_px,
                     const std::string& what) {
  const Eigen::ArrayXd off_px = (made_px - true_px).rowwise().norm();
  const auto near = static_cast<double>((off_px <= kMatchBound_px).count());
  return share(static_cast<double>(off_px.size()) - near, off_px.size(), what);
}

Deviation of_mask(const Scene& scene, const InlierMask& mask) {
  double wrong = 0.0;
  for (std::int64_t i = 0; i < mask.kept.rows(); ++i) {
    wrong += mask.kept(i) != scene.matches.correct[to_index(i)] ? 1.0 : 0.0;
  }
  return share(wrong, mask.kept.rows(), "verdicts are wrong");
}

Deviation of_shape(const Scene& scene, const Shape& shape) {
  const double mean_m =
      mean_distance(shape.vertices_m.matrix<3>(), scene.shape.vertices_m.matrix<3>());
  return {mean_m, shape_bound_m(scene.templ),
          "its shape is off by " + std::to_string(1000.0 * mean_m) + " mm in the mean"};
}

Deviation of_warp(const Scene& scene, const Asked& asked, const Points2& texels_px) {
  const double mean_px =
      asked.warped_px ? mean_distance(*asked.warped_px, true_pixels(scene, texels_px)) : INFINITY;
  return {mean_px, kMatchBound_px,
          "its warp is off by " + std::to_string(mean_px) + " px in the mean"};
}

Deviation of_lines(const Scene& scene, const Sightlines& lines) {
  Points2 true_px(lines.count(), 2);
  const Points3 vertices_m = scene.shape.vertices_m.matrix<3>();
  for (std::int64_t i = 0; i < lines.count(); ++i) {
    const Eigen::RowVector3d weights = lines.barycentrics.matrix<3>().row(i);
    const Eigen::Vector3d place_m =
        lines.vertex(i) >= 0
            ? Eigen::Vector3d(vertices_m.row(lines.vertex(i)))
            : Eigen::Vector3d(
                  interpolate(vertices_m, scene.templ.faces.matrix<3>(), lines.face(i), weights));
    true_px.row(i) = project(pinhole(scene.camera), place_m).transpose();
  }
  return far_pixels(lines.pixel_px.matrix<2>(), true_px, "sightlines pass the surface by");
}

Deviation of_visibility(const Visibility& seen) {
  double hidden = 0.0;
  for (std::int64_t v = 0; v < seen.visible.rows(); ++v) hidden += seen.visible(v) == 0 ? 1.0 : 0.0;
  return share(hidden, seen.visible.rows(), "vertices in plain view are reported as hidden");
}

Deviation of_region(const Scene& scene, const Region& region) {
  const Points2 seen_px = project_points(pinhole(scene.camera), scene.shape.vertices_m.matrix<3>());
  double outside = 0.0;
  for (Eigen::Index v = 0; v < seen_px.rows(); ++v) {
    const std::int64_t x = std::llround(seen_px(v, 0)), y = std::llround(seen_px(v, 1));
    outside += region.mask(y, x) == 0 ? 1.0 : 0.0;
  }
  return share(outside, seen_px.rows(), "vertices lie beyond its region");
}

}  // namespace

double shape_bound_m(const Template& templ) {
  const auto vertices_m = templ.vertices_m.matrix<3>();
  return 0.02 * (vertices_m.colwise().maxCoeff() - vertices_m.colwise().minCoeff()).norm();
}

Scene drawn_scene(const Subject& subject, double mismatches, double noise_px, int round) {
  const bool judges = subject.rules().marks || subject.produces("correspondences");
  return make_scene(0,
                    {.count = judges ? 400 : 200,
                     .correct_rate = judges ? 1.0 - mismatches : 1.0,
                     .noise_px = noise_px,
                     .label_distance_px = kMatchBound_px + 5.0 * noise_px},
                    round);
}

std::vector<Deviation> deviations_of(const Scene& scene, const Asked& asked,
                                     const Points2& texels_px) {
  std::vector<Deviation> all;
  for (const auto& [slot, record] : asked.answer.outputs) {
    if (const auto mask = typed_in<InlierMask>(record)) all.push_back(of_mask(scene, *mask));
    if (const auto shape = typed_in<Shape>(record)) all.push_back(of_shape(scene, *shape));
    if (typed_in<Warp>(record)) all.push_back(of_warp(scene, asked, texels_px));
    if (const auto lines = typed_in<Sightlines>(record)) all.push_back(of_lines(scene, *lines));
    if (const auto seen = typed_in<Visibility>(record)) all.push_back(of_visibility(*seen));
    if (const auto region = typed_in<Region>(record)) all.push_back(of_region(scene, *region));
    if (const auto matches = typed_in<Correspondences>(record)) {
      all.push_back(far_pixels(matches->image_px.matrix<2>(),
                               true_pixels(scene, matches->template_px.matrix<2>()),
                               "matches are wrong"));
    }
  }
  return all;
}

}  // namespace weft::testing
