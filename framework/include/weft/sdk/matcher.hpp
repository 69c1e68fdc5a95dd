// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/export.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

struct MatcherInput {
  Call call;
  std::optional<Keypoints> keypoints{};            ///< of the image
  std::optional<Keypoints> template_keypoints{};   ///< with face and barycentrics
  std::vector<Correspondences> correspondences{};  ///< of earlier matchers, to merge

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("keypoints", self.keypoints);
    visit("template_keypoints", self.template_keypoints);
    visit("correspondences", self.correspondences);
  }
};

/// Role `matchers`: pairs of points of the template and of the image, all marked as kept.
class Matcher : public Prepared {
 public:
  virtual Result<Correspondences> match(const MatcherInput& in) = 0;

  static Role role() {
    return {
        "matchers",
        {role_method<MatcherInput>("match", {output_slot<Correspondences>("correspondences")})}};
  }

  std::int32_t process(ProcessCall& call) {
    return call.run<MatcherInput>("correspondences", [&](const auto& in) { return match(in); });
  }
};

}  // namespace weft
