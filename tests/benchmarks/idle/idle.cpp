// SPDX-License-Identifier: Apache-2.0
// Components that do next to nothing, so that what a call takes is the host's, and one that ends
// its process.
#include <unistd.h>

#include <chrono>
#include <thread>
#include <weft/sdk/detector.hpp>
#include <weft/sdk/sink.hpp>

namespace {

class Nothing final : public weft::Sink {
 public:
  static constexpr weft::About kAbout{.reads = "time"};
  explicit Nothing(weft::Params&) {}
  weft::Result<void> open(const weft::Call&) override { return {}; }
  weft::Result<void> write(const weft::SinkInput&) override { return {}; }
  weft::Result<void> finish(const weft::Call&) override { return {}; }
};

/// One keypoint where the image is brightest in its middle row; ends the process in one frame.
class Glance final : public weft::Detector {
 public:
  explicit Glance(weft::Params& p) {
    p.read("prepare_ms", prepare_ms_, "ms", {0, 10'000}, "time that it takes to prepare");
    p.read("last_frame", last_frame_, "", {-1, 1e9}, "in which it ends the process, -1 for none");
  }
  weft::Result<void> prepare(const weft::PrepareInput&) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(prepare_ms_));
    return {};
  }
  weft::Result<weft::Keypoints> detect(const weft::DetectorInput& in) override {
    if (last_frame_ >= 0 && in.call.frame() == static_cast<std::uint64_t>(last_frame_)) _exit(1);
    const auto& pixels = in.image.pixels;
    const std::int64_t row = pixels.dim(0) / 2;
    std::int64_t brightest = 0;
    for (std::int64_t x = 0; x < pixels.dim(1); ++x) {
      if (pixels(row, x) > pixels(row, brightest)) brightest = x;
    }
    weft::Keypoints found;
    found.xy_px = weft::Array<double>({1, 2}, static_cast<double>(row));
    found.xy_px(0, 0) = static_cast<double>(brightest);
    found.scale_px = found.angle_rad = found.response = weft::Array<double>({1}, 1.0);
    found.octave = weft::Array<std::int32_t>({1}, 0);
    found.metric = "l2";
    found.descriptors = weft::Array<float>({1, 1}, 1.0F);
    return found;
  }

 private:
  int prepare_ms_ = 0;
  std::int64_t last_frame_ = -1;
};

}  // namespace

WEFT_LIBRARY(WEFT_COMPONENT(Nothing, "sinks/bench.nothing", "1.0.0", "Does nothing."),
             WEFT_COMPONENT(Glance, "detectors/bench.glance", "1.0.0", "Looks at one row."))
