// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>
#include <weft/sdk/matcher.hpp>

#include "abandoned.hpp"
#include "common/ratio_matching.hpp"
#include "device_choice.hpp"
#include "search.hpp"

namespace weft::sift_gpu {

/// Nearest descriptor with Lowe's ratio test, exact, on an OpenCL device.
class GpuMatcher final : public Matcher {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Lowe, Distinctive image features from scale-invariant keypoints, IJCV 2004; "
          "Arandjelovic and Zisserman, Three things everyone should know to improve object "
          "retrieval, CVPR 2012",
      .determinism = "tolerance",
      .needs = "keypoints template_keypoints",
      .device_memory = &kDeviceMemory<KeptDescriptors>};

  explicit GpuMatcher(Params& p);
  Result<void> prepare(const PrepareInput& /*in*/) override { return device_.prepare(); }
  Result<Correspondences> match(const MatcherInput& in) override;
  static std::vector<std::string> devices() { return descriptions(); }

 private:
  std::vector<matchers::Neighbours> search(const matchers::Sides& sides,
                                           const CancelledCheck& cancelled);

  DeviceChoice device_;
  MatcherComponent fallback_{"matchers/descriptor"};
  matchers::RatioMatching matching_;
  std::unique_ptr<Search> search_;
  Abandoned<Search> abandoned_;
  std::vector<float> places_;
};

}  // namespace weft::sift_gpu
