// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <weft/sdk/detector.hpp>

#include "abandoned.hpp"
#include "device_choice.hpp"
#include "session.hpp"

namespace weft::sift_gpu {

/// SIFT as OpenCV computes it, on an OpenCL device.
class SiftGpu final : public Detector {
 public:
  static constexpr About kAbout{.reference = detectors::kSiftReference,
                                .determinism = "tolerance",
                                .reads = "region",
                                .device_memory = &kDeviceMemory<KeptDescriptors>};

  explicit SiftGpu(Params& p);
  Result<void> prepare(const PrepareInput& /*in*/) override { return device_.prepare(); }
  Result<Keypoints> detect(const DetectorInput& in) override;
  static std::vector<std::string> devices() { return descriptions(); }

 private:
  void let_go();
  Result<void> make_session(const std::shared_ptr<Device>& device,
                            const Array<std::uint8_t>& pixels);
  Result<Keypoints> answer(const DetectorInput& in, const CancelledCheck& cancelled);
  cv::KeyPoint in_image(const Spot& spot) const;

  DeviceChoice device_;
  DetectorComponent fallback_{"detectors/sift"};
  detectors::SiftParameters asked_;
  std::unique_ptr<Session> session_;
  Abandoned<Session> abandoned_;
};

}  // namespace weft::sift_gpu
