// SPDX-License-Identifier: Apache-2.0
#include "detector.hpp"

#include <cmath>
#include <numbers>
#include <vector>
#include <weft/core/index.hpp>

#include "common/answer.hpp"
#include "common/grey_image.hpp"
#include "common/selection.hpp"

namespace weft::sift_gpu {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

std::string mebibytes(std::uint64_t bytes) {
  return std::to_string(std::lrint(std::ceil(static_cast<double>(bytes) / kMiB))) + " MiB";
}

}  // namespace

SiftGpu::SiftGpu(Params& p) {
  device_.read(p);
  p.component("fallback", fallback_,
              "detector that replaces this one, with its own parameters; see without_device");
  asked_.read(p);
}

/// Without waiting for descriptors on which the device may still be at work.
void SiftGpu::let_go() {
  if (session_ != nullptr) abandoned_.keep(std::move(session_));
  abandoned_.bury();
}

Result<void> SiftGpu::make_session(const std::shared_ptr<Device>& device,
                                   const Array<std::uint8_t>& pixels) {
  const auto width = static_cast<int>(pixels.dim(1)), height = static_cast<int>(pixels.dim(0));
  const int channels = pixels.ndim() == 3 ? 3 : 1;
  if (session_ != nullptr && session_->fits(*device, width, height, channels)) return {};
  let_go();
  const ScalePlan plan(width, height, asked_.settings);
  const std::uint64_t needed = Session::bytes_needed(plan, channels);
  const std::uint64_t largest = Session::largest_buffer_bytes(plan);
  if (needed > device->memory_bytes() || largest > device->largest_buffer_bytes()) {
    return Error{Errc::unsupported,
                 "an image of " + std::to_string(width) + " x " + std::to_string(height) +
                     " needs " + mebibytes(needed) + ", " + mebibytes(largest) +
                     " of it in one piece; " + device->name() + " has " +
                     mebibytes(device->memory_bytes()) + ", at most " +
                     mebibytes(device->largest_buffer_bytes()) +
                     " in one piece; set upsample: false, give smaller images or choose another "
                     "device"};
  }
  session_ = std::make_unique<Session>(device, width, height, channels, asked_.settings);
  return {};
}

/// A spot with its place and scale in px of the image. The enlarged image has its pixel edges on
/// those of the image.
cv::KeyPoint SiftGpu::in_image(const Spot& spot) const {
  const int octave = spot.octave - (asked_.settings.upsample ? 1 : 0);
  const double pitch_px = std::exp2(octave);
  const double edge_px = asked_.settings.upsample ? 0.25 : 0.0;
  return {static_cast<float>(spot.x * pitch_px - edge_px),
          static_cast<float>(spot.y * pitch_px - edge_px),
          static_cast<float>(spot.scale * pitch_px),
          static_cast<float>(spot.angle * 180.0 / std::numbers::pi),
          spot.response,
          octave};
}

Result<Keypoints> SiftGpu::answer(const DetectorInput& in, const CancelledCheck& cancelled) {
  const std::vector<Spot> spots = session_->find(in.image.pixels, cancelled);
  std::vector<cv::KeyPoint> keypoints;
  keypoints.reserve(spots.size());
  for (const Spot& spot : spots) keypoints.push_back(in_image(spot));
  const cv::Size size(static_cast<int>(in.image.pixels.dim(1)),
                      static_cast<int>(in.image.pixels.dim(0)));
  const std::vector<int> order =
      detectors::selection(keypoints, size, in.region ? &in.region->mask : nullptr,
                           asked_.max_keypoints, asked_.buckets);

  std::vector<Spot> selected;
  std::vector<cv::KeyPoint> selected_keypoints;
  for (const int i : order) {
    selected.push_back(spots[to_index(i)]);
    selected_keypoints.push_back(keypoints[to_index(i)]);
  }
  // A blob of Gaussian profile answers strongest between the two blurs whose difference was
  // taken.
  auto found = detectors::answer(selected_keypoints, cv::Mat(0, kDescriptorLength, CV_32F),
                                 std::exp2(0.5 / asked_.settings.octave_layers));
  if (!selected.empty()) {
    found->descriptors =
        on_device<float>(session_->describe(selected),
                         {static_cast<std::int64_t>(selected.size()), kDescriptorLength});
  }
  return found;
}

Result<Keypoints> SiftGpu::detect(const DetectorInput& in) {
  if (auto valid = detectors::check(in); !valid) return valid.error();
  const auto device = device_.open();
  if (!device) return device.error();
  if (*device == nullptr) return device_.flagged(in.call, fallback_.detect(in));
  const Array<std::uint8_t>& pixels = in.image.pixels;
  const std::string doing = "finding keypoints in an image of " + std::to_string(pixels.dim(1)) +
                            " x " + std::to_string(pixels.dim(0)) + " on " + (*device)->name();
  abandoned_.bury();
  try {
    if (auto fits = make_session(*device, pixels); !fits) return fits.error();
    return answer(in, [&] { return in.call.cancelled(); });
  } catch (const cl::Error& failure) {
    session_.reset();
    device_.give_up();
    return error_of(failure, doing);
  } catch (const Cancelled&) {
    let_go();
    return Error{Errc::cancelled, "cancelled while " + doing};
  }
}

}  // namespace weft::sift_gpu
