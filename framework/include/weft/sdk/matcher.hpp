// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/export.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

struct MatcherInput {
  Call call;
  OptionalInput<Keypoints> keypoints{};           ///< of the image
  OptionalInput<Keypoints> template_keypoints{};  ///< with face and barycentrics
  ListInput<Correspondences> correspondences{};   ///< of earlier matchers, to merge
  OptionalInput<Image> image{};
  OptionalInput<Template> templ{};
  OptionalInput<Camera> camera{};
  OptionalInput<Shape> shape{};  ///< of an earlier solver of this frame
  OptionalInput<Image> previous_image{};
  OptionalInput<Correspondences> previous_correspondences{};  ///< with the marks of filters
  OptionalInput<Shape> previous_shape{};                      ///< may be `lost`: see its state

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

/// Role `matchers`: pairs of points of the template and of the image, all marked as kept. One pairs
/// keypoints, unites matches, or follows those of the previous frame.
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

/// A matcher of keypoints that a component holds, for example to stand in for it.
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
