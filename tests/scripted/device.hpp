// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numeric>
#include <weft/core/index.hpp>
#include <weft/sdk/device.hpp>

#include "matches.hpp"

namespace scripted {

/// Numbers in a memory that only this library can read.
class RemoteNumbers {
 public:
  RemoteNumbers(std::vector<float> numbers, bool is_lost)
      : numbers_(std::move(numbers)), is_lost_(is_lost) {}

  const std::vector<float>& numbers() const { return numbers_; }

  weft::Result<void> download(std::span<std::byte> to,
                              const std::function<bool()>& cancelled) const {
    if (is_lost_) return weft::Error{weft::Errc::io, "scripted loss", ""};
    if (cancelled()) return weft::Error{weft::Errc::cancelled, "scripted patience", ""};
    std::copy(numbers_.begin(), numbers_.end(), reinterpret_cast<float*>(to.data()));
    return {};
  }

 private:
  std::vector<float> numbers_;
  bool is_lost_;
};

/// The grid, with descriptors 1, 2, 3 ... that stay in this library's memory. Without `kSaysSo` the
/// component does not declare that memory.
template <bool kSaysSo>
class DeviceDetector final : public weft::Detector {
 public:
  static constexpr weft::About kAbout{.device_memory =
                                          kSaysSo ? &weft::kDeviceMemory<RemoteNumbers> : nullptr};

  explicit DeviceDetector(weft::Params& p) : grid_(p) {
    read_frames(p, "lost_at", lost_, "frames whose descriptors cannot be fetched");
    read_frames(p, "nan_there_at", nan_there_, "frames whose descriptors hold NaN");
    read_frames(p, "scale_there_at", scale_there_, "frames that keep what must be here there");
  }

  static std::vector<std::string> devices() { return {"scripted device", "another one"}; }

  weft::Result<weft::Keypoints> detect(const weft::DetectorInput& in) override {
    auto found = grid_.detect(in);
    if (!found) return found;
    const std::int64_t count = found->count();
    std::vector<float> numbers(weft::to_index(4 * count));
    std::iota(numbers.begin(), numbers.end(), 1.0F);
    if (has(nan_there_, in.call)) numbers.back() = std::numeric_limits<float>::quiet_NaN();
    found->descriptors = weft::on_device<float>(
        std::make_shared<const RemoteNumbers>(std::move(numbers), has(lost_, in.call)), {count, 4});
    if (has(scale_there_, in.call)) {
      found->scale_px = weft::on_device<double>(
          std::make_shared<const RemoteNumbers>(std::vector<float>(), true), {count});
    }
    return found;
  }

 private:
  GridDetector grid_;
  Frames lost_, nan_there_, scale_there_;
};

/// Pairs by index, with a score of 1 if all descriptors were read on the device, else of 0. An
/// error where they are not those of the detector.
template <bool kReadsThere>
class DescriptorReader final : public weft::Matcher {
 public:
  static constexpr weft::About kAbout{
      .needs = "keypoints template_keypoints",
      .device_memory = kReadsThere ? &weft::kDeviceMemory<RemoteNumbers> : nullptr};

  explicit DescriptorReader(weft::Params& p) : pairs_(p) {}

  weft::Result<weft::Correspondences> match(const weft::MatcherInput& in) override {
    auto matches = pairs_.match(in);
    if (!matches) return matches;
    bool all_there = true;
    for (const weft::Keypoints& points : {*in.keypoints, *in.template_keypoints}) {
      const weft::Array<float>& descriptors = points.descriptors;
      std::vector<float> expected(weft::to_index(descriptors.size())), found;
      std::iota(expected.begin(), expected.end(), 1.0F);
      if (const auto there = weft::device_contents<RemoteNumbers>(descriptors)) {
        found = there->numbers();
      } else {
        found.assign(descriptors.data(), descriptors.data() + descriptors.size());
        all_there = false;
      }
      if (found != expected) {
        return weft::Error{weft::Errc::invalid_data, "these are other descriptors", ""};
      }
    }
    std::fill_n(matches->score.data(), matches->count(), all_there ? 1.0 : 0.0);
    return matches;
  }

 private:
  IndexMatcher pairs_;
};

/// A matcher that passes the detector's device arrays, or an array that it makes itself, to another
/// matcher.
class HandingMatcher final : public weft::Matcher {
 public:
  static constexpr weft::About kAbout{.needs = "keypoints template_keypoints",
                                      .device_memory = &weft::kDeviceMemory<RemoteNumbers>};

  explicit HandingMatcher(weft::Params& p) {
    p.component("reader", reader_, "who reads");
    p.read("own", own_, "hand on an array that the host has never seen");
  }

  weft::Result<weft::Correspondences> match(const weft::MatcherInput& in) override {
    weft::Keypoints points = *in.keypoints;
    if (own_) {
      points.descriptors = weft::on_device<float>(
          std::make_shared<const RemoteNumbers>(std::vector<float>(), true), {points.count(), 4});
    }
    return reader_.match(in.call, points, *in.template_keypoints);
  }

 private:
  weft::MatcherComponent reader_{"matchers/test.reading"};
  bool own_ = false;
};

/// A matcher that finds the keypoints itself, by another component, which may keep them there.
template <bool kReadsThere>
class FindingMatcher final : public weft::Matcher {
 public:
  static constexpr weft::About kAbout{
      .needs = "keypoints template_keypoints",
      .device_memory = kReadsThere ? &weft::kDeviceMemory<RemoteNumbers> : nullptr};

  explicit FindingMatcher(weft::Params& p) : reader_(p) {
    p.component("detector", detector_, "who finds them");
  }

  weft::Result<weft::Correspondences> match(const weft::MatcherInput& in) override {
    weft::DetectorInput wanted{in.call};
    wanted.image.pixels = weft::Array<std::uint8_t>({1, 1}, 0);
    auto found = detector_.detect(wanted);
    if (!found) return found.error();
    weft::MatcherInput given = in;
    given.keypoints = *std::move(found);
    return reader_.match(given);
  }

 private:
  weft::DetectorComponent detector_{"detectors/test.device"};
  DescriptorReader<kReadsThere> reader_;
};

}  // namespace scripted
