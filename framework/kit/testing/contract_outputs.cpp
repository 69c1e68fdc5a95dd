// SPDX-License-Identifier: Apache-2.0
#include "kit/testing/contract_outputs.hpp"

#include <algorithm>
#include <cmath>
#include <weft/geometry/check_sightlines.hpp>

namespace weft::testing {
namespace {

template <class T>
bool all_within(const Array<T>& values, double low, double high) {
  return std::all_of(values.data(), values.data() + values.size(), [&](T value) {
    return static_cast<double>(value) >= low && static_cast<double>(value) <= high;
  });
}

bool is_flag(const Array<std::uint8_t>& values) { return all_within(values, 0, 1); }

/// Without an image, a component takes the size from the camera.
bool is_mask_of_image(const Case& given, const Region& made) {
  const Array<std::uint8_t>& pixels = given.scene.image.pixels;
  const Camera& camera = given.scene.camera;
  const bool has_image = given.gives("image");
  return made.mask.dim(0) == (has_image ? pixels.dim(0) : camera.height_px) &&
         made.mask.dim(1) == (has_image ? pixels.dim(1) : camera.width_px) && is_flag(made.mask);
}

void check_keypoints(const Case& given, const Keypoints& made, Checks& checks) {
  const Array<std::uint8_t>& pixels = given.scene.image.pixels;
  const Array<std::uint8_t>& mask = given.scene.region.mask;
  const bool has_region = given.gives("region");
  const bool bits = made.metric == "hamming";
  checks.expect(bits || made.metric == "l2", "the metric is '" + made.metric + "'");
  const std::int64_t described = bits ? made.binary_descriptors.rows() : made.descriptors.rows();
  checks.expect(described == made.count(), "a keypoint has no descriptor of its metric");
  for (std::int64_t i = 0; i < made.count(); ++i) {
    const auto x = std::lround(made.xy_px(i, 0)), y = std::lround(made.xy_px(i, 1));
    const bool inside = made.xy_px(i, 0) >= -0.5 && made.xy_px(i, 1) >= -0.5 &&
                        made.xy_px(i, 0) <= static_cast<double>(pixels.dim(1)) - 0.5 &&
                        made.xy_px(i, 1) <= static_cast<double>(pixels.dim(0)) - 0.5;
    if (!inside) return checks.fail("keypoint " + std::to_string(i) + " is outside the image");
    if (!has_region) continue;
    const bool in_mask = y >= 0 && x >= 0 && y < mask.dim(0) && x < mask.dim(1) && mask(y, x) != 0;
    if (!in_mask) return checks.fail("keypoint " + std::to_string(i) + " is outside the region");
  }
}

void check_matches(const Case& given, const Correspondences& made, Checks& checks) {
  // One that merges matches behind filters hands on what they rejected.
  const bool none_rejected = all_within(given.scene.matches.matches.kept, 1, 1);
  checks.expect(!none_rejected || all_within(made.kept, 1, 1), "a match is not marked as kept");
  const auto names = [&](const Array<std::int32_t>& index, std::int64_t count, const char* what) {
    const bool fits = !index.present() || all_within(index, -1, static_cast<double>(count) - 1);
    checks.expect(fits, std::string("a match names no ") + what);
  };
  names(made.template_keypoint, given.scene.template_keypoints.count(), "keypoint of the template");
  names(made.image_keypoint, given.scene.keypoints.count(), "keypoint of the image");
  names(made.face, given.scene.templ.faces.rows(), "face of the template");
}

void check_mask(const Case& given, const InlierMask& made, Checks& checks) {
  const Correspondences& matches = given.scene.matches.matches;
  checks.expect(is_flag(made.kept), "its mask has entries that are not 0 or 1");
  if (made.confidence.present()) {
    checks.expect(all_within(made.confidence, 0, 1), "its confidence is not in 0 to 1");
  }
  for (std::int64_t i = 0; i < std::min(matches.count(), made.kept.rows()); ++i) {
    const bool takes_back = matches.kept(i) == 0 && made.kept(i) != 0;
    if (takes_back) return checks.fail("it keeps match " + std::to_string(i) + ", rejected before");
  }
}

void check_visibility(const Visibility& made, Checks& checks) {
  checks.expect(is_flag(made.visible), "its visibility has entries that are not 0 or 1");
  checks.expect(all_within(made.score, 0, 1), "a score of its visibility is not in 0 to 1");
  checks.expect(all_within(made.reason, 0, 4), "a vertex is hidden for no reason that there is");
}

void check_sight(const Scene& scene, const Sightlines& made, Checks& checks) {
  const auto fit = check_sightlines(made, scene.templ.vertices_m.rows(), scene.templ.faces.rows());
  if (!fit) checks.fail(fit.error().message);
  checks.expect(made.coverage >= 0.0 && made.coverage <= 1.0, "its coverage is not in 0 to 1");
}

void check_registration(const Registration& made, Checks& checks) {
  checks.expect(is_flag(made.found), "its registration has entries that are not 0 or 1");
  for (std::int64_t i = 0; i < made.count(); ++i) {
    const bool is_measured =
        std::isfinite(made.displacement_mm(i, 0)) && std::isfinite(made.displacement_mm(i, 1));
    if (is_measured == (made.found(i) != 0)) continue;
    return checks.fail("patch " + std::to_string(i) + " is " + (is_measured ? "not " : "") +
                       "found, with" + (is_measured ? " a" : "out a") + " displacement");
  }
}

void check_shape(const Case& given, const Shape& made, Checks& checks) {
  const ShapeState state = made.shape_state();
  checks.expect(state == ShapeState::estimated || state == ShapeState::weak,
                std::string("its shape is '") + to_string(state) +
                    "': a solver may set estimated or weak, the host sets the others");
  checks.expect(made.confidence >= 0.0 && made.confidence <= 1.0,
                "its confidence is not in 0 to 1");
  checks.expect(is_flag(made.source), "its source has entries that are not 0 or 1");
  if (given.expect != Expect::answer) return;
  for (std::int64_t v = 0; v < made.vertices_m.rows(); ++v) {
    if (made.vertices_m(v, 2) > 0.0) continue;
    return checks.fail("vertex " + std::to_string(v) + " of its shape lies behind the camera");
  }
}

}  // namespace

void check_answer(const Answer& answer, Checks& checks) {
  if (answer.status == WEFT_CANCELLED)
    return checks.fail("reports cancelled without a cancellation");
  // The host writes this text if a component left it empty.
  const bool no_reason =
      answer.message.empty() || answer.message.starts_with("gave no reason for its status");
  if (answer.status != WEFT_OK && no_reason) {
    return checks.fail("reports " + to_text(answer) + " without a reason");
  }
  const bool broken = answer.status == WEFT_ERROR && answer.code == Errc::plugin_failure;
  const bool threw = answer.message.starts_with("threw: ") && answer.message.size() > 7;
  if (broken && !threw) checks.fail(answer.message);
}

bool is_nothing(const Answer& answer) {
  for (const auto& [slot, record] : answer.outputs) {
    if (const auto keypoints = typed_in<Keypoints>(record)) return keypoints->count() == 0;
    if (const auto matches = typed_in<Correspondences>(record)) return matches->count() == 0;
    if (const auto lines = typed_in<Sightlines>(record)) return lines->count() == 0;
    if (const auto mask = typed_in<InlierMask>(record)) {
      const Array<std::uint8_t>& kept = mask->kept;
      return std::all_of(kept.data(), kept.data() + kept.size(), [](auto k) { return k == 0; });
    }
  }
  return false;
}

void check_outputs(const Subject& subject, const Case& given, const Answer& answer,
                   Checks& checks) {
  const Scene& scene = given.scene;
  for (const auto& [slot, record] : answer.outputs) {
    checks.expect(subject.produces(slot), "it makes '" + slot + "', which it does not announce");
    if (const auto made = typed_in<Keypoints>(record)) check_keypoints(given, *made, checks);
    if (const auto made = typed_in<Correspondences>(record)) check_matches(given, *made, checks);
    if (const auto made = typed_in<InlierMask>(record)) check_mask(given, *made, checks);
    if (const auto made = typed_in<Sightlines>(record)) check_sight(scene, *made, checks);
    if (const auto made = typed_in<Visibility>(record)) check_visibility(*made, checks);
    if (const auto made = typed_in<Registration>(record)) check_registration(*made, checks);
    if (const auto made = typed_in<Shape>(record)) check_shape(given, *made, checks);
    if (const auto made = typed_in<Warp>(record)) {
      checks.expect(made->producer == subject.manifest().id,
                    "its warp names '" + made->producer + "' as its producer");
    }
    if (const auto made = typed_in<Region>(record)) {
      checks.expect(is_mask_of_image(given, *made),
                    "its region is no mask of the size of the image");
    }
    if (const auto made = typed_in<ObjectMask>(record)) {
      const Array<std::uint8_t>& pixels = scene.image.pixels;
      checks.expect(made->known.dim(0) == pixels.dim(0) && made->known.dim(1) == pixels.dim(1),
                    "its object_mask has another size than the image");
    }
  }
}

}  // namespace weft::testing
