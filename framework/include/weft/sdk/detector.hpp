// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/export.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

struct DetectorInput {
  Call call;
  Image image{};
  OptionalInput<Region> region{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("image", self.image);
    visit("region", self.region);
  }
};

/// Role `detectors`: keypoints with descriptors. The host runs it on every image and once on the
/// template's texture with the template's mask as region.
class Detector : public Prepared {
 public:
  static constexpr const char* kRole = "detectors";
  virtual Result<Keypoints> detect(const DetectorInput& in) = 0;

  static constexpr std::uint64_t kMethods = 0b1;
  static Role role() {
    return {kRole, {role_method<DetectorInput>("detect", {output_slot<Keypoints>("keypoints")})}};
  }

  std::int32_t process(ProcessCall& call) {
    return call.run<DetectorInput>("keypoints", [&](const auto& in) { return detect(in); });
  }
};

/// A nested detector, for example as a fallback.
struct DetectorComponent : ComponentHandle {
  explicit DetectorComponent(const char* default_component)
      : ComponentHandle{"detectors", default_component} {}

  Result<Keypoints> detect(const DetectorInput& in) const {
    const RecordView<Image> image("image", in.image);
    detail::Inputs inputs;
    inputs.push_back(image.raw());
    std::optional<RecordView<Region>> region;
    if (in.region) inputs.push_back(region.emplace("region", *in.region).raw());
    return detail::invoke<Keypoints>(in.call, handle, 0, inputs);
  }
};

}  // namespace weft
