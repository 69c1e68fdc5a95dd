// SPDX-License-Identifier: Apache-2.0
#include <weft/sdk/source.hpp>

namespace {

/// Two frames with all that a source may give.
struct Small final : weft::Source {
  static constexpr weft::About kAbout{
      .produces = "image time known_points ground_truth correspondences region"};
  std::int64_t frames = 2;

  explicit Small(weft::Params& p) { p.read("frames", frames, "", {1, 9}, "number of frames"); }

  weft::Result<weft::Camera> open(const weft::Call&) override {
    return weft::Camera{8.0, 8.0, 3.5, 2.5, 8, 6};
  }
  std::int64_t count() const override { return frames; }

  weft::Result<weft::SourceFrame> read(std::int64_t index, const weft::Call&) override {
    if (index >= frames) return weft::no_more_frames("there are no more");
    weft::SourceFrame frame;
    frame.image.emplace();
    frame.image->pixels = weft::Array<std::uint8_t>({6, 8});
    for (std::int64_t i = 0; i < 48; ++i) {
      frame.image->pixels.data()[i] = static_cast<std::uint8_t>(5 * i + index);
    }
    frame.image->stem = "small";
    frame.time = weft::Time{0.5 * static_cast<double>(index)};
    frame.region.emplace();
    frame.region->mask = weft::Array<std::uint8_t>({6, 8}, 1);
    frame.known_points.emplace();
    frame.known_points->vertex = weft::Array<std::int32_t>({1}, 0);
    frame.known_points->points_m = weft::Array<double>({1, 3}, 0.25);
    frame.known_points->radius_m = weft::Array<double>({1}, 0.125);
    return frame;
  }
};

}  // namespace

WEFT_PLUGIN(Small, "sources/kept.small", "1.0.0", "Two small frames.")
