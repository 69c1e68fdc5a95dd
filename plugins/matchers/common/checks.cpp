// SPDX-License-Identifier: Apache-2.0
#include "common/checks.hpp"

#include <cmath>
#include <string>

#include "common/distances/row_kernels.hpp"

namespace weft::matchers {
namespace {

Error invalid(std::string message) { return {Errc::invalid_data, std::move(message), {}}; }

std::string name(std::int64_t i, const char* side) {
  return "keypoint " + std::to_string(i) + " of the " + side;
}

Result<void> check_places(const Keypoints& keypoints, const char* side) {
  for (std::int64_t i = 0; i < keypoints.count(); ++i) {
    if (!std::isfinite(keypoints.xy_px(i, 0)) || !std::isfinite(keypoints.xy_px(i, 1)) ||
        !std::isfinite(keypoints.angle_rad(i))) {
      return invalid(name(i, side) +
                     " has a place or angle that is NaN or infinite; "
                     "the detector must leave such keypoints out");
    }
    if (!(keypoints.scale_px(i) > 0.0) || !std::isfinite(keypoints.scale_px(i))) {
      return invalid(name(i, side) + " has scale " + std::to_string(keypoints.scale_px(i)) +
                     "; scales must be positive and finite");
    }
  }
  return {};
}

Result<void> check_floats(const Keypoints& keypoints, const char* side, bool root_sift) {
  if (keypoints.descriptors.is_on_device()) return {};  // by the plugin that reads them there
  for (std::int64_t i = 0; i < keypoints.count(); ++i) {
    const RowSurvey survey =
        survey_row(keypoints.descriptors.row(i), static_cast<int>(keypoints.descriptors.dim(1)));
    if (!survey.is_finite) {
      return invalid("the descriptor of " + name(i, side) +
                     " holds NaN or infinity; the detector must leave such keypoints out");
    }
    if (root_sift && survey.lowest < 0.0F) {
      return invalid("the descriptor of " + name(i, side) +
                     " holds a negative number, which has no root; set root_sift: false");
    }
  }
  return {};
}

template <class T>
Result<void> check_lengths(const Array<T>& templ, const Array<T>& image) {
  if (!templ.present() || !image.present()) {
    return invalid(std::string("the keypoints of the ") + (templ.present() ? "image" : "template") +
                   " have no descriptors; use a detector that describes its keypoints");
  }
  if (templ.dim(1) != image.dim(1) || templ.dim(1) == 0) {
    return invalid("descriptors of the template have length " + std::to_string(templ.dim(1)) +
                   ", those of the image " + std::to_string(image.dim(1)) +
                   "; use the same detector for both");
  }
  return {};
}

}  // namespace

Result<void> check(const Keypoints& templ, const Keypoints& image, bool root_sift,
                   bool template_passed) {
  if (templ.metric != image.metric) {
    return invalid("the template's keypoints have metric '" + templ.metric + "', the image's '" +
                   image.metric + "'; use the same detector for both");
  }
  if (!template_passed) {
    if (auto places = check_places(templ, "template"); !places) return places;
  }
  if (auto places = check_places(image, "image"); !places) return places;
  if (templ.metric == "hamming") {
    return check_lengths(templ.binary_descriptors, image.binary_descriptors);
  }
  if (templ.metric != "l2") {
    return invalid("metric '" + templ.metric + "' is unknown; it must be l2 or hamming");
  }
  if (auto same = check_lengths(templ.descriptors, image.descriptors); !same) return same;
  if (!template_passed) {
    if (auto floats = check_floats(templ, "template", root_sift); !floats) return floats;
  }
  return check_floats(image, "image", root_sift);
}

}  // namespace weft::matchers
