// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/export.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

struct PassInput {
  Call call;
  Template templ{};
  Camera camera{};
  OptionalInput<Image> image{};
  OptionalInput<Warp> warp{};                 ///< evaluate with weft::evaluate()
  OptionalInput<WarpSamples> warp_samples{};  ///< samples at the template's vertices
  OptionalInput<Correspondences> correspondences{};
  OptionalInput<Shape> shape{};
  OptionalInput<Visibility> visibility{};
  OptionalInput<ObjectMask> object_mask{};
  OptionalInput<Shape> previous_shape{};
  OptionalInput<Visibility> previous_visibility{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("template", self.templ);
    visit("camera", self.camera);
    visit("image", self.image);
    visit("warp", self.warp);
    visit("warp_samples", self.warp_samples);
    visit("correspondences", self.correspondences);
    visit("shape", self.shape);
    visit("visibility", self.visibility);
    visit("object_mask", self.object_mask);
    visit("previous.shape", self.previous_shape);
    visit("previous.visibility", self.previous_visibility);
  }
};

/// Outputs of a pass, filled according to its About::produces.
struct PassOutput {
  std::optional<Sightlines> sightlines{};      ///< rays of surface points
  std::optional<Visibility> visibility{};      ///< visible vertices
  std::optional<Region> region{};              ///< usable part of the image
  std::optional<Registration> registration{};  ///< displacements of texture patches
  std::optional<ObjectMask> object_mask{};     ///< pixels that show the object
};

/// Role `passes`: prepares data for the solver from the data of the frame, or measures its result.
class Pass : public Prepared {
 public:
  static constexpr const char* kRole = "passes";
  virtual Result<PassOutput> run(const PassInput& in) = 0;

  static constexpr std::uint64_t kMethods = 0b1;
  static Role role() {
    return {kRole,
            {role_method<PassInput>("run", {output_slot<Sightlines>("sightlines", false),
                                            output_slot<Visibility>("visibility", false),
                                            output_slot<Region>("region", false),
                                            output_slot<Registration>("registration", false),
                                            output_slot<ObjectMask>("object_mask", false)})}};
  }

  std::int32_t process(ProcessCall& call) {
    return call.run_with<PassInput>([&](const auto& in) { return run(in); },
                                    [&](const PassOutput& out) {
                                      Result<void> status =
                                          call.write("sightlines", out.sightlines);
                                      if (status) status = call.write("visibility", out.visibility);
                                      if (status) status = call.write("region", out.region);
                                      if (status) {
                                        status = call.write("registration", out.registration);
                                      }
                                      if (status) {
                                        status = call.write("object_mask", out.object_mask);
                                      }
                                      return status;
                                    });
  }
};

}  // namespace weft
