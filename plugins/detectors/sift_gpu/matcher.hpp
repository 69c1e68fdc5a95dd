// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>
#include <weft/sdk/matcher.hpp>

#include "abandoned.hpp"
#include "common/ratio_matching.hpp"
#include "search.hpp"

namespace weft::sift_gpu {

/// Nearest descriptor with Lowe's ratio test, exact, on a device that speaks OpenCL.
class GpuMatcher final : public Matcher {
 public:
  static constexpr About kAbout{
      .reference =
          "Lowe, Distinctive image features from scale-invariant keypoints, IJCV 2004; "
          "Arandjelovic and Zisserman, Three things everyone should know to improve object "
          "retrieval, CVPR 2012",
      .determinism = "tolerance",
      .needs = "keypoints template_keypoints"};

  explicit GpuMatcher(Params& p);
  Result<void> prepare(const PrepareInput& in) override;
  Result<Correspondences> match(const MatcherInput& in) override;

 private:
  Result<void> open();
  std::vector<matchers::Neighbours> search(const matchers::Sides& sides,
                                           const CancelledCheck& cancelled);
  DeviceDescriptors load(const Keypoints& keypoints);

  std::string device_name_;
  matchers::RatioMatching matching_;
  std::shared_ptr<Device> device_;
  std::unique_ptr<Search> search_;
  Abandoned<Search> abandoned_;
  std::vector<float> packed_, places_;
};

}  // namespace weft::sift_gpu
