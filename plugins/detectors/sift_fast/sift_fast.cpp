// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/sdk/detector.hpp>

#include "common/answer.hpp"
#include "common/grey_image.hpp"
#include "common/selection.hpp"
#include "common/sift_parameters.hpp"
#include "search.hpp"

namespace weft::sift_fast {
namespace {

/// Part of the image in which keypoints are looked for.
struct Box {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Where the mask [H,W] is not 0; no pixels where it is 0 all over.
Box box_of(const Array<std::uint8_t>& mask) {
  const auto width = static_cast<int>(mask.dim(1)), height = static_cast<int>(mask.dim(0));
  int left = width, right = -1, top = height, bottom = -1;
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* row = mask.row(y);
    const auto inside = [](std::uint8_t value) { return value != 0; };
    const auto first = static_cast<int>(std::find_if(row, row + width, inside) - row);
    if (first == width) continue;
    int last = width - 1;
    while (row[last] == 0) --last;
    left = std::min(left, first);
    right = std::max(right, last);
    top = std::min(top, y);
    bottom = y;
  }
  if (right < 0) return {};
  return {left, top, right - left + 1, bottom - top + 1};
}

/// SIFT with vector instructions, in whole numbers.
class SiftFast final : public Detector {
 public:
  static constexpr About kAbout{.reference = detectors::kSiftReference, .reads = "region"};

  explicit SiftFast(Params& p) {
    asked_.read(p);
    p.read("margin_px", margin_px_, "px", {0, 10000},
           "width of the border around the region that is included in blurs and descriptors");
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
    const Array<std::uint8_t>* mask = in.region ? &in.region->mask : nullptr;
    choose_box(grey.size(), mask);
    if (box_.width == 0) return answer({}, 1);
    const int threads = std::max(in.call.threads(), 1);
    const GreyImage image{grey.ptr(box_.y) + box_.x, static_cast<std::ptrdiff_t>(grey.step[0]),
                          box_.width, box_.height};
    return answer(choose(search_->find(image, threads), grey.size(), mask, threads), threads);
  }

 private:
  void make_search() { search_ = std::make_unique<Search>(asked_.settings); }

  /// The pixels of octaves up to 3 lie on the same places with and without a region.
  void choose_box(cv::Size image, const Array<std::uint8_t>* mask) {
    constexpr int kPitch = 8;
    box_ = {0, 0, image.width, image.height};
    if (mask == nullptr) return;
    const Box inner = box_of(*mask);
    if (inner.width == 0) {
      box_ = {};
      return;
    }
    const int left = std::max(inner.x - margin_px_, 0) / kPitch * kPitch;
    const int top = std::max(inner.y - margin_px_, 0) / kPitch * kPitch;
    box_ = {left, top, std::min(inner.x + inner.width + margin_px_, image.width) - left,
            std::min(inner.y + inner.height + margin_px_, image.height) - top};
  }

  /// A spot with its place and scale in px of the image. The enlarged image has its pixel edges on
  /// those of the image.
  cv::KeyPoint in_image(const Spot& spot) const {
    const int octave = spot.octave - (asked_.settings.upsample ? 1 : 0);
    const float pitch_px = std::ldexp(1.0F, octave);
    const float edge_px = asked_.settings.upsample ? 0.25F : 0.0F;
    return {static_cast<float>(box_.x) + (spot.x * pitch_px - edge_px),
            static_cast<float>(box_.y) + (spot.y * pitch_px - edge_px),
            spot.scale * pitch_px,
            static_cast<float>(static_cast<double>(spot.angle) * 180.0 / std::numbers::pi),
            spot.response,
            octave};
  }

  void take(std::span<const Spot> spots, std::span<const int> order) {
    chosen_.clear();
    for (const int i : order) chosen_.push_back(spots[to_index(i)]);
  }
  const std::vector<cv::KeyPoint>& in_image(std::span<const Spot> spots) {
    keypoints_.clear();
    for (const Spot& spot : spots) keypoints_.push_back(in_image(spot));
    return keypoints_;
  }

  /// Keypoints with angles, in their order. The cap is applied to extrema, so that only these get
  /// angles, and then to keypoints.
  std::span<const Spot> choose(std::span<const Spot> extrema, cv::Size image,
                               const Array<std::uint8_t>* mask, int threads) {
    take(extrema,
         selector_.choose(in_image(extrema), image, mask, asked_.max_keypoints, asked_.buckets));
    const std::span<const Spot> oriented = search_->orient(chosen_, threads);
    take(oriented, selector_.choose(in_image(oriented), image, nullptr, asked_.max_keypoints,
                                    asked_.buckets));
    return chosen_;
  }

  Result<Keypoints> answer(std::span<const Spot> chosen, int threads) {
    // A blob of Gaussian profile answers strongest between the two blurs whose difference was
    // taken.
    auto result = detectors::answer(in_image(chosen), cv::Mat(0, kDescriptorLength, CV_32F),
                                    std::exp2(0.5 / asked_.settings.octave_layers));
    if (chosen.empty()) return result;
    result->descriptors =
        Array<float>({static_cast<std::int64_t>(chosen.size()), kDescriptorLength});
    search_->describe(chosen, result->descriptors.data(), threads);
    return result;
  }

  detectors::SiftParameters asked_;
  int margin_px_ = 16;
  std::unique_ptr<Search> search_;
  cv::Mat grey_;
  Box box_;
  detectors::Selector selector_;
  std::vector<cv::KeyPoint> keypoints_;
  std::vector<Spot> chosen_;
};

}  // namespace
}  // namespace weft::sift_fast

WEFT_PLUGIN(weft::sift_fast::SiftFast, "detectors/sift_fast", "1.0.1",
            "Detects the SIFT keypoints of detectors/sift with vector instructions.")
