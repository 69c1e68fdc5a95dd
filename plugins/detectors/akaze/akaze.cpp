// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <opencv2/features2d.hpp>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/sdk/detector.hpp>

#include "common/answer.hpp"
#include "common/grey_image.hpp"
#include "common/selection.hpp"

namespace weft::akaze {
namespace {

constexpr int kChannels = 3;          // intensity and both derivatives
constexpr int kDescriptorBytes = 61;  // all 486 bits: a shorter one draws random bits
constexpr int kSmallestSidePx = 2;    // OpenCV fails below
/// OpenCV's size is a diameter, and 1.5 times that of the level at which derivatives are taken.
constexpr double kSigmaPerSize = 1.0 / 3.0;

/// Blobs and corners of a nonlinear scale space, which keeps the edges between regions sharp.
class Akaze final : public Detector {
 public:
  static constexpr About kAbout{.reference =
                                    "paper: Alcantarilla, Nuevo and Bartoli, Fast explicit "
                                    "diffusion for accelerated features in "
                                    "nonlinear scale spaces, BMVC 2013",
                                .reads = "region"};

  explicit Akaze(Params& p) {
    p.read("max_keypoints", max_keypoints_, "", {0, 1000000},
           "maximum number of keypoints, the strongest ones spread over the image; 0: no limit");
    p.read("buckets", buckets_, "", {1, 256},
           "number of cells per side over which max_keypoints is spread; 1: no spreading");
    p.read("octaves", octaves_, "", {1, 8}, "maximum number of octaves; small images have fewer");
    p.read("octave_layers", octave_layers_, "", {1, 10}, "number of scales per octave");
    p.read("threshold", threshold_, "", {1e-8, 1},
           "minimum determinant of the Hessian, for grey levels from 0 to 1");
  }

  Result<Keypoints> detect(const DetectorInput& in) override {
    if (auto valid = detectors::check(in); !valid) return valid.error();
    if (in.call.cancelled()) return Error{Errc::cancelled, "cancelled"};
    const cv::Mat grey = detectors::grey_image(in.image.pixels, grey_);
    std::vector<cv::KeyPoint> found;
    cv::Mat described;
    if (std::min(grey.rows, grey.cols) >= kSmallestSidePx) {
      cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, kChannels, static_cast<float>(threshold_),
                        octaves_, octave_layers_)
          ->detectAndCompute(grey, cv::noArray(), found, described);
    }

    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors(0, kDescriptorBytes, CV_8U);
    const auto* mask = in.region ? &in.region->mask : nullptr;
    for (const int i : detectors::selection(found, grey.size(), mask, max_keypoints_, buckets_)) {
      keypoints.push_back(found[to_index(i)]);
      descriptors.push_back(described.row(i));
    }
    return detectors::answer(keypoints, descriptors, kSigmaPerSize);
  }

 private:
  int max_keypoints_ = 6000;
  int buckets_ = 16;
  int octaves_ = 4;
  int octave_layers_ = 4;
  double threshold_ = 0.0002;
  cv::Mat grey_;
};

}  // namespace
}  // namespace weft::akaze

using weft::akaze::Akaze;
WEFT_PLUGIN(Akaze, "detectors/akaze", "1.0.0",
            "Detects AKAZE keypoints in a nonlinear scale space, with descriptors of 486 bits.")
