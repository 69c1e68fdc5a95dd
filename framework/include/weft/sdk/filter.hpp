// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <weft/sdk/export.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

struct FilterInput {
  Call call;
  Correspondences correspondences{};
  OptionalInput<Template> templ{};
  OptionalInput<Camera> camera{};
  OptionalInput<Shape> previous_shape{};
  OptionalInput<GroundTruth> ground_truth{};  ///< only for components that declare uses_truth

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("correspondences", self.correspondences);
    visit("template", self.templ);
    visit("camera", self.camera);
    visit("previous.shape", self.previous_shape);
    visit("ground_truth", self.ground_truth);
  }
};

/// Role `filters`: marks matches as kept or rejected, with scores, and never drops or reorders
/// them. A rejected match stays rejected: the host combines the masks.
class Filter : public Prepared {
 public:
  static constexpr const char* kRole = "filters";
  virtual Result<InlierMask> filter(const FilterInput& in) = 0;

  static constexpr std::uint64_t kMethods = 0b1;
  static Role role() {
    return {kRole, {role_method<FilterInput>("filter", {output_slot<InlierMask>("inlier_mask")})}};
  }

  std::int32_t process(ProcessCall& call) {
    return call.run<FilterInput>("inlier_mask", [&](const auto& in) { return filter(in); });
  }
};

/// A nested filter, for example for a part of the matches.
struct FilterComponent : ComponentHandle {
  explicit FilterComponent(const char* default_component)
      : ComponentHandle{"filters", default_component} {}

  Result<InlierMask> filter(const FilterInput& in) const {
    detail::Inputs inputs;
    const RecordView<Correspondences> matches("correspondences", in.correspondences);
    inputs.push_back(matches.raw());
    std::optional<RecordView<Template>> templ;
    std::optional<RecordView<Camera>> camera;
    std::optional<RecordView<Shape>> previous;
    if (in.templ) inputs.push_back(templ.emplace("template", *in.templ).raw());
    if (in.camera) inputs.push_back(camera.emplace("camera", *in.camera).raw());
    if (in.previous_shape) {
      inputs.push_back(previous.emplace("previous.shape", *in.previous_shape).raw());
    }
    return detail::invoke<InlierMask>(in.call, handle, 0, inputs);
  }
};

}  // namespace weft
