// SPDX-License-Identifier: Apache-2.0
#include <weft/sdk/detector.hpp>

namespace {

/// A keypoint at every pixel that is brighter than a threshold.
struct Small final : weft::Detector {
  int brighter_than = 200;

  explicit Small(weft::Params& p) {
    p.read("brighter_than", brighter_than, "grey levels", {0, 255}, "of a keypoint");
  }

  weft::Result<weft::Keypoints> detect(const weft::DetectorInput& in) override {
    const auto& pixels = in.image.pixels;
    std::int64_t count = 0;
    for (std::int64_t i = 0; i < pixels.size(); ++i) count += pixels.data()[i] > brighter_than;
    if (count == 0) return weft::no_result("nothing is brighter");
    weft::Keypoints found;
    found.xy_px = weft::Array<double>({count, 2});
    found.scale_px = weft::Array<double>({count}, 1.0);
    found.angle_rad = weft::Array<double>({count}, 0.0);
    found.response = weft::Array<double>({count});
    found.octave = weft::Array<std::int32_t>({count}, 0);
    found.metric = "l2";
    found.descriptors = weft::Array<float>({count, 2});
    std::int64_t k = 0;
    for (std::int64_t y = 0; y < pixels.dim(0); ++y) {
      for (std::int64_t x = 0; x < pixels.dim(1); ++x) {
        if (pixels(y, x) <= brighter_than) continue;
        found.xy_px(k, 0) = static_cast<double>(x);
        found.xy_px(k, 1) = static_cast<double>(y);
        found.response(k) = pixels(y, x);
        found.descriptors(k, 0) = static_cast<float>(pixels(y, x));
        found.descriptors(k, 1) = static_cast<float>(x);
        ++k;
      }
    }
    return found;
  }
};

}  // namespace

WEFT_PLUGIN(Small, "detectors/kept.small", "1.0.0", "Finds bright pixels.")
