// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/sdk/detector.hpp>

#include "common/answer.hpp"
#include "common/grey_image.hpp"
#include "common/inference/input_map.hpp"
#include "common/selection.hpp"
#include "detector_network.hpp"

namespace weft::onnx {
namespace {

/// Keypoints and descriptors of a network that the user gives as an ONNX file.
class Onnx final : public Detector {
 public:
  static constexpr About kAbout{.reference = "own: keypoints of any network in an ONNX file",
                                .reads = "region"};

  explicit Onnx(Params& p) {
    p.input_path("network", network_path_,
                 "network file NAME.yaml of a detector; the ONNX file is in the same folder",
                 Need::required);
    p.read("threshold", threshold_, "", {-1e6, 1e6},
           "minimum score of a keypoint, in the unit of the network");
    p.read("max_keypoints", max_keypoints_, "", {0, 1000000},
           "maximum number of keypoints, the strongest ones spread over the image; 0: no limit");
    p.read("buckets", buckets_, "", {1, 256},
           "number of cells per side over which max_keypoints is spread; 1: no spreading");
    inference::read_runtime(p, runtime_);
  }

  void check(Mistakes& mistakes) const {
    mistakes.expect("network", DetectorNetwork::check(network_path_, runtime_));
    mistakes.expect("runtime", inference::Engine::check(runtime_));
  }

  Result<void> prepare(const PrepareInput& /*in*/) override { return open(); }

  Result<Keypoints> detect(const DetectorInput& in) override {
    if (auto valid = detectors::check(in); !valid) return valid.error();
    if (auto opened = open(); !opened) return opened.error();
    ask_to_go_on();
    const Array<std::uint8_t>& pixels = in.image.pixels;
    const cv::Size frame_px(static_cast<int>(pixels.dim(1)), static_cast<int>(pixels.dim(0)));
    if (!map_ || frame_px != frame_px_) {
      map_ = inference::InputMap::fit(frame_px, network_->file().image.size_px);
      frame_px_ = frame_px;
    }
    if (auto ran = network_->run(map_->image(pixels), in.call.threads()); !ran) return ran.error();
    return collect(in.region ? &in.region->mask : nullptr);
  }

 private:
  Result<void> open() {
    if (network_) return {};
    auto opened = DetectorNetwork::open(network_path_, runtime_);
    if (!opened) return about("network", opened.error());
    network_.emplace(*std::move(opened));
    return {};
  }

  /// True if a place is on a pixel of the frame and not on the filled rest.
  bool is_in_frame(const cv::Point2f& place) const {
    return place.x >= -0.5F && place.y >= -0.5F &&
           place.x < static_cast<float>(frame_px_.width) - 0.5F &&
           place.y < static_cast<float>(frame_px_.height) - 0.5F;
  }

  Result<Keypoints> collect(const Array<std::uint8_t>* mask) const {
    std::vector<int> list;
    const std::vector<Peak> peaks = network_->keypoints(threshold_, list);
    std::vector<cv::KeyPoint> found;
    for (std::size_t n = 0; n < peaks.size(); ++n) {
      const auto place = map_->to_frame(peaks[n].x_px, peaks[n].y_px);
      const cv::Point2f place_px(static_cast<float>(place[0]), static_cast<float>(place[1]));
      if (!is_in_frame(place_px)) continue;
      const auto pixel = static_cast<float>(1.0 / map_->scale()[0]);
      found.emplace_back(place_px, pixel, 0.0F, peaks[n].score, 0, static_cast<int>(n));
    }
    std::vector<cv::KeyPoint> kept;
    std::vector<cv::Point2d> places_px;
    std::vector<int> kept_list;
    for (const int i : detectors::selection(found, frame_px_, mask, max_keypoints_, buckets_)) {
      const auto n = to_index(found[to_index(i)].class_id);
      kept.push_back(found[to_index(i)]);
      places_px.emplace_back(peaks[n].x_px, peaks[n].y_px);
      if (!list.empty()) kept_list.push_back(list[n]);
    }
    return detectors::answer(kept, network_->descriptors(places_px, kept_list), 1.0);
  }

  std::string network_path_;
  inference::Runtime runtime_ = inference::Runtime::opencv;
  double threshold_ = 0.01;
  int max_keypoints_ = 4000;
  int buckets_ = 16;
  std::optional<DetectorNetwork> network_;
  std::optional<inference::InputMap> map_;
  cv::Size frame_px_;
};

}  // namespace
}  // namespace weft::onnx

using weft::onnx::Onnx;
WEFT_PLUGIN(Onnx, "detectors/onnx", "1.0.0",
            "Detects and describes keypoints by a network that is given as an ONNX file.")
