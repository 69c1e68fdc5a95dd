// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/data/matrix.hpp>

#include "kit/testing/contract_cases.hpp"
#include "kit/testing/geometry/bounds.hpp"
#include "kit/testing/geometry/check_geometry.hpp"

namespace weft::testing {
namespace {

constexpr double kSame = 1e-6;  ///< [] px, px/px; of second derivatives in lengths of a texture

/// The texture is the image.
Scene unmoved_scene(const Subject& subject) {
  Scene scene = drawn_scene(subject, 0.0, 0.0, 0);
  scene.camera.width_px = scene.templ.texture.dim(1);
  scene.camera.height_px = scene.templ.texture.dim(0);
  Correspondences& all = scene.matches.matches;
  scene.matches.true_px = all.template_px.matrix<2>();
  all.image_px = make_array<double>(scene.matches.true_px);
  scene.follow_matches();
  return scene;
}

}  // namespace

void check_identity_warp(const Subject& subject, Checks& checks) {
  checks.begin("identity warp");
  const Scene scene = unmoved_scene(subject);
  Performer performer(subject);
  if (const auto ready = performer.begin(scene.templ, scene.camera); !ready) {
    return checks.fail(ready.error().message);
  }
  const Answer fitted = performer.call(kRunStage, inputs_of(subject, scene));
  const HostRecord warp = fitted.find("warp");
  if (warp == nullptr) return checks.fail("reports " + to_text(fitted));
  const Points2 texels_px = inner_texels(scene.templ);
  const Answer answer = performer.evaluate(warp, {make_array<double>(texels_px), 2});
  const auto samples = answer.get<WarpSamples>("warp_samples");
  if (!samples) return checks.fail("reports " + to_text(answer));
  const double width_px = static_cast<double>(scene.templ.texture.dim(1));
  Eigen::MatrixXd first = Eigen::MatrixXd::Zero(texels_px.rows(), 4);
  first.col(0).setOnes();
  first.col(3).setOnes();
  const double value = (samples->xy_px.matrix<2>() - texels_px).cwiseAbs().maxCoeff();
  const double slope = (samples->jacobian.matrix<4>() - first).cwiseAbs().maxCoeff();
  const double bend = width_px * samples->hessian.matrix<6>().cwiseAbs().maxCoeff();
  if (!(value <= width_px * kSame)) checks.fail("is off by " + std::to_string(value) + " px");
  if (!(slope <= kSame)) checks.fail("its jacobian is off by " + std::to_string(slope));
  if (!(bend <= kSame)) checks.fail("its hessian is not 0");
}

}  // namespace weft::testing
