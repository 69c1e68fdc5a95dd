// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/export.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

struct FitInput {
  Call call;
  Correspondences correspondences{};  ///< only matches with kept = 1 count
  Template templ{};
  OptionalInput<Weights> weights{};  ///< weight per match; 1 if absent

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("correspondences", self.correspondences);
    visit("template", self.templ);
    visit("weights", self.weights);
  }
};

struct EvaluateInput {
  Call call;
  Warp warp{};
  Points points{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("warp", self.warp);
    visit("points", self.points);
  }
};

/// Role `warps`: a smooth map from the template's texture to the image. evaluate() depends only on
/// the record, never on earlier fits.
class WarpModel : public Prepared {
 public:
  static constexpr const char* kRole = "warps";
  virtual Result<Warp> fit(const FitInput& in) = 0;
  virtual Result<WarpSamples> evaluate(const EvaluateInput& in) = 0;

  static constexpr std::uint64_t kMethods = 0b11;
  static Role role() {
    return {kRole,
            {role_method<FitInput>("fit", {output_slot<Warp>("warp")}),
             role_method<EvaluateInput>("evaluate", {output_slot<WarpSamples>("warp_samples")})}};
  }

  std::int32_t process(ProcessCall& call) {
    if (call.method() == 0) {
      return call.run<FitInput>("warp", [&](const auto& in) { return fit(in); });
    }
    return call.run<EvaluateInput>("warp_samples", [&](const auto& in) { return evaluate(in); });
  }
};

}  // namespace weft
