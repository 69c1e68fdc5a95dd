// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/export.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

struct MatcherInput {
  Call call;
  OptionalInput<Keypoints> keypoints{};  ///< keypoints of the image
  OptionalInput<Keypoints>
      template_keypoints{};  ///< keypoints of the template with face and barycentrics
  ListInput<Correspondences> correspondences{};  ///< matches of earlier matchers, for merging
  OptionalInput<Image> image{};
  OptionalInput<Template> templ{};
  OptionalInput<Camera> camera{};
  OptionalInput<Shape> shape{};  ///< shape of an earlier solver of this frame
  OptionalInput<Image> previous_image{};
  OptionalInput<Correspondences>
      previous_correspondences{};         ///< previous matches with the marks of filters
  OptionalInput<Shape> previous_shape{};  ///< may be `lost`: check its state

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("keypoints", self.keypoints);
    visit("template_keypoints", self.template_keypoints);
    visit("correspondences", self.correspondences);
    visit("image", self.image);
    visit("template", self.templ);
    visit("camera", self.camera);
    visit("shape", self.shape);
    visit("previous.image", self.previous_image);
    visit("previous.correspondences", self.previous_correspondences);
    visit("previous.shape", self.previous_shape);
  }
};

/// Role `matchers`: pairs of template and image points, all marked as kept. A matcher pairs
/// keypoints, merges matches, or tracks those of the previous frame.
class Matcher : public Prepared {
 public:
  static constexpr const char* kRole = "matchers";
  virtual Result<Correspondences> match(const MatcherInput& in) = 0;

  static constexpr std::uint64_t kMethods = 0b1;
  static Role role() {
    return {
        kRole,
        {role_method<MatcherInput>("match", {output_slot<Correspondences>("correspondences")})}};
  }

  std::int32_t process(ProcessCall& call) {
    return call.run<MatcherInput>("correspondences", [&](const auto& in) { return match(in); });
  }
};

/// A nested matcher of keypoints, for example as a fallback.
struct MatcherComponent : ComponentHandle {
  explicit MatcherComponent(const char* default_component)
      : ComponentHandle{"matchers", default_component} {}

  Result<Correspondences> match(const Call& call, const Keypoints& keypoints,
                                const Keypoints& template_keypoints) const {
    const RecordView<Keypoints> image("keypoints", keypoints);
    const RecordView<Keypoints> templ("template_keypoints", template_keypoints);
    const weft_record inputs[] = {image.raw(), templ.raw()};
    return detail::invoke<Correspondences>(call, handle, 0, inputs);
  }
};

}  // namespace weft
