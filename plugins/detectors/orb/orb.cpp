// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <weft/sdk/detector.hpp>

#include "common/answer.hpp"
#include "common/grey_image.hpp"
#include "search.hpp"

namespace weft::orb {
namespace {

/// Oriented FAST corners with rotated BRIEF descriptors, on the pixel grid of the whole image.
class Orb final : public Detector {
 public:
  static constexpr About kAbout{.reference =
                                    "paper: Rublee, Rabaud, Konolige and Bradski, ORB: an "
                                    "efficient alternative to SIFT or SURF, "
                                    "ICCV 2011",
                                .reads = "region"};

  explicit Orb(Params& p) {
    p.read("max_keypoints", settings_.max_keypoints, "", {0, 1000000},
           "strongest keypoints kept, spread over the image; 0 keeps all");
    p.read("buckets", settings_.buckets, "", {1, 256},
           "cells per side over which the cap spreads the keypoints; 1 does not spread them");
    p.read("levels", settings_.levels, "", {1, 32},
           "levels of the pyramid; small images have fewer");
    p.read("scale_factor", settings_.scale_factor, "", {1.05, 2},
           "size of a level over that of the next");
    p.read("fast_threshold", settings_.fast_threshold, "grey levels", {1, 254},
           "how much brighter or darker the circle around a corner must be");
    p.read("border_px", settings_.border_px, "px", {16, 1000},
           "no keypoint within this of the border of its level");
  }

  Result<void> prepare(const PrepareInput& /*in*/) override {
    make_search();
    return {};
  }

  Result<Keypoints> detect(const DetectorInput& in) override {
    if (auto valid = detectors::check(in); !valid) return valid.error();
    if (in.call.cancelled()) return Error{Errc::cancelled, "cancelled"};
    if (search_ == nullptr) make_search();
    const cv::Mat grey = detectors::grey_image(in.image.pixels, grey_);
    search_->run(grey, in.region ? &in.region->mask : nullptr, in.call.threads());
    return detectors::answer(search_->keypoints(), search_->descriptors(), kBlurPx / kPatchPx);
  }

 private:
  void make_search() { search_ = std::make_unique<Search>(settings_); }

  Settings settings_;
  std::unique_ptr<Search> search_;
  cv::Mat grey_;
};

}  // namespace
}  // namespace weft::orb

using weft::orb::Orb;
WEFT_PLUGIN(Orb, "detectors/orb", "1.1.0",
            "Finds ORB keypoints and describes them with 256 bits each; fast.")
