// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <opencv2/features2d.hpp>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/sdk/detector.hpp>

#include "common/answer.hpp"
#include "common/grey_image.hpp"
#include "common/selection.hpp"
#include "common/sift_parameters.hpp"

namespace weft::sift {
namespace {

/// OpenCV doubles the image with pixel edges aligned (x2 = 2 x + 0.5) but maps positions back by
/// x2 / 2, at every octave.
constexpr float kDoublingOffsetPx = 0.25F;
constexpr int kDescriptorLength = 128;
constexpr int kDoubledOctave = -1;

int octave_of(const cv::KeyPoint& keypoint) {
  return static_cast<std::int8_t>(static_cast<std::uint8_t>(keypoint.octave & 0xFF));
}

/// Keypoints as OpenCV gives them and their descriptors, row by row.
struct Found {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
};

/// Scale-invariant keypoints of Lowe with positions freed of the bias of the doubled image.
class Sift final : public Detector {
 public:
  static constexpr About kAbout{.reference = detectors::kSiftReference, .reads = "region"};

  explicit Sift(Params& p) { asked_.read_without_upsample(p); }

  Result<void> prepare(const PrepareInput& /*in*/) override {
    make_detector();
    return {};
  }

  Result<Keypoints> detect(const DetectorInput& in) override {
    if (auto valid = detectors::check(in); !valid) return valid.error();
    if (in.call.cancelled()) return Error{Errc::cancelled, "cancelled"};
    if (detector_ == nullptr) make_detector();
    const cv::Mat grey = detectors::grey_image(in.image.pixels, grey_);
    return answer(select(grey, in.region ? &in.region->mask : nullptr));
  }

 private:
  void make_detector() {
    const detectors::SiftSettings& settings = asked_.settings;
    detector_ = cv::SIFT::create(0, settings.octave_layers, settings.contrast_threshold,
                                 settings.edge_threshold, settings.sigma_px);
  }

  /// The keypoints of the answer in their order, with descriptors. Describing everything at once
  /// saves a second pyramid; describing the selection alone is cheaper when it leaves much out.
  /// Both give the same descriptors, so the choice may rest on the image before.
  Found select(const cv::Mat& grey, const Array<std::uint8_t>* mask) {
    Found found;
    const bool describe_all = !selection_drops_much_;
    if (describe_all) {
      detector_->detectAndCompute(grey, cv::noArray(), found.keypoints, found.descriptors);
    } else {
      detector_->detect(grey, found.keypoints);
    }
    const std::vector<int> order = selection(found.keypoints, grey.size(), mask);
    selection_drops_much_ = 4 * order.size() < 3 * found.keypoints.size();

    Found selected;
    for (const int i : order) {
      selected.keypoints.push_back(found.keypoints[to_index(i)]);
    }
    if (describe_all) {
      selected.descriptors.create(static_cast<int>(order.size()), kDescriptorLength, CV_32F);
      for (std::size_t i = 0; i < order.size(); ++i) {
        found.descriptors.row(order[i]).copyTo(selected.descriptors.row(static_cast<int>(i)));
      }
    } else {
      selected.descriptors = order.empty() ? cv::Mat(0, kDescriptorLength, CV_32F)
                                           : describe(grey, selected.keypoints);
    }
    return selected;
  }

  std::vector<int> selection(std::vector<cv::KeyPoint> keypoints, cv::Size image,
                             const Array<std::uint8_t>* mask) const {
    for (cv::KeyPoint& keypoint : keypoints) {
      keypoint.pt -= cv::Point2f(kDoublingOffsetPx, kDoublingOffsetPx);
    }
    return detectors::selection(keypoints, image, mask, asked_.max_keypoints, asked_.buckets);
  }

  /// OpenCV builds the doubled octave only if a keypoint lies in it, and describes the others
  /// differently without it: one more keypoint there keeps descriptors independent of the
  /// selection.
  cv::Mat describe(const cv::Mat& grey, std::vector<cv::KeyPoint> keypoints) {
    cv::KeyPoint doubled = keypoints.front();
    doubled.octave = (kDoubledOctave & 0xFF) | (1 << 8);
    doubled.size = 2.0F;
    keypoints.push_back(doubled);
    cv::Mat descriptors;
    detector_->compute(grey, keypoints, descriptors);
    return descriptors.rowRange(0, descriptors.rows - 1);
  }

  Result<Keypoints> answer(Found found) const {
    for (cv::KeyPoint& keypoint : found.keypoints) {
      keypoint.pt -= cv::Point2f(kDoublingOffsetPx, kDoublingOffsetPx);
      keypoint.octave = octave_of(keypoint);
    }
    // A blob of Gaussian profile answers strongest between the two scales whose difference was
    // taken, and OpenCV names the finer one.
    return detectors::answer(found.keypoints, found.descriptors,
                             0.5 * std::exp2(0.5 / asked_.settings.octave_layers));
  }

  detectors::SiftParameters asked_;
  cv::Ptr<cv::SIFT> detector_;
  cv::Mat grey_;
  bool selection_drops_much_ = false;
};

}  // namespace
}  // namespace weft::sift

using weft::sift::Sift;
WEFT_PLUGIN(Sift, "detectors/sift", "1.0.0",
            "Detects SIFT keypoints with descriptors of 128 numbers.")
