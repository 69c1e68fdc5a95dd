// SPDX-License-Identifier: Apache-2.0
#include <thread>
#include <weft/core/index.hpp>

#include "session.hpp"
#include "sift_gpu_alone.hpp"

namespace weft::sift_gpu {
namespace {

using ::testing::HasSubstr;

TEST(SiftGpuPlugin, TakesItsDeviceByIndexOrName) {
  const Image image = texture(64, 48, 81);
  PluginUnderTest usual("detectors/sift_gpu");
  const PluginAnswer expected = detect(usual, image);
  const std::string name = all_devices().front().getInfo<CL_DEVICE_NAME>();
  for (const std::string& device : {std::string("0"), std::string("'0'"), "'" + name + "'"}) {
    PluginUnderTest plugin("detectors/sift_gpu", "{device: " + device + "}");
    EXPECT_TRUE(same_keypoints(detect(plugin, image), expected)) << device;
  }
}

TEST(SiftGpuPlugin, AnswersAnUnknownDeviceWithWhatThereIs) {
  PluginUnderTest plugin("detectors/sift_gpu", "{device: no such device}");
  const PluginAnswer outcome = detect(plugin, texture(64, 48, 81));
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_EQ(outcome.code, Errc::not_found);
  EXPECT_THAT(outcome.message, HasSubstr("'no such device'"));
  EXPECT_THAT(outcome.message, HasSubstr("0: " + description(all_devices().front())));
}

TEST(SiftGpuPlugin, CountsTheBytesOfImagesOfAnySize) {
  for (const auto& [width, height, upsample] :
       {std::tuple{640, 480, true}, std::tuple{3840, 2160, true}, std::tuple{7, 5, false},
        std::tuple{60000, 60000, false}, std::tuple{100000, 100000, true}}) {
    const ScalePlan plan(width, height, Settings{.upsample = upsample});
    const auto pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    const std::uint64_t first = upsample ? 4 * pixels : pixels;
    const std::uint64_t spots = std::max<std::uint64_t>(1024, first / 200);
    EXPECT_EQ(Session::bytes_needed(plan, 3),
              3 * pixels + 4 * (plan.pyramid_size + first) + 2 * sizeof(Spot) * spots)
        << width << " x " << height;
    EXPECT_EQ(Session::largest_buffer_bytes(plan), 4 * plan.pyramid_size);
    // Each octave has a quarter of the pixels of the one before.
    EXPECT_LE(plan.pyramid_size, 6 * first * 4 / 3);
    EXPECT_GE(plan.pyramid_size, 6 * first);
  }
}

TEST(SiftGpuPlugin, RefusesAnImageForWhichTheDeviceIsTooSmallAndTakesTheNext) {
  const auto device = Device::open("");
  ASSERT_TRUE(device);
  const auto too_large = [&](int side) {
    const ScalePlan plan(side, side, Settings{});
    return Session::largest_buffer_bytes(plan) > (*device)->largest_buffer_bytes() ||
           Session::bytes_needed(plan, 1) > (*device)->memory_bytes();
  };
  int side = 64;
  while (!too_large(side)) side *= 2;
  // Every row is the same memory: the test does not need the whole image.
  const std::vector<std::uint8_t> row(to_index(side), 128);
  Image huge;
  huge.pixels = Array<std::uint8_t>::borrow(row.data(), 2, {side, side}, 0);

  PluginUnderTest plugin("detectors/sift_gpu"), other("detectors/sift_gpu");
  const Image image = texture(64, 48, 82);
  const PluginAnswer expected = detect(other, image);
  const PluginAnswer outcome = detect(plugin, huge);
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_EQ(outcome.code, Errc::unsupported);
  const std::string size = std::to_string(side) + " x " + std::to_string(side);
  EXPECT_THAT(outcome.message, HasSubstr("an image of " + size + " needs "));
  EXPECT_THAT(outcome.message, HasSubstr((*device)->name()));
  EXPECT_THAT(outcome.message, HasSubstr("upsample: false"));
  EXPECT_TRUE(same_keypoints(detect(plugin, image), expected));
}

/// A GPU may answer before the first check for cancellation.
bool may_be_too_fast() {
  return (all_devices().front().getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_GPU) != 0;
}

TEST(SiftGpuPlugin, StopsWhenItsCallIsCancelledAndAnswersTheNext) {
  const Image image = texture(160, 120, 83);
  PluginUnderTest plugin("detectors/sift_gpu"), other("detectors/sift_gpu");
  const PluginAnswer expected = detect(other, image);
  detect(plugin, image);  // opens the device, so that the work is cancelled
  for (int i = 0; i < 3; ++i) {
    plugin.cancel() = true;
    const PluginAnswer outcome = detect(plugin, image);
    plugin.cancel() = false;
    if (outcome.status == WEFT_OK && may_be_too_fast()) {
      EXPECT_TRUE(same_keypoints(outcome, expected));
      continue;
    }
    EXPECT_EQ(outcome.status, WEFT_CANCELLED);
    EXPECT_EQ(outcome.code, Errc::cancelled);
    EXPECT_TRUE(same_keypoints(detect(plugin, image), expected));
  }
}

TEST(SiftGpuPlugin, MayBeEndedRightAfterACancelledCall) {
  const Image image = texture(160, 120, 84);
  PluginUnderTest survivor("detectors/sift_gpu");
  const PluginAnswer expected = detect(survivor, image);
  {
    PluginUnderTest plugin("detectors/sift_gpu");
    detect(plugin, image);
    plugin.cancel() = true;
    EXPECT_TRUE(detect(plugin, image).status == WEFT_CANCELLED || may_be_too_fast());
  }
  EXPECT_TRUE(same_keypoints(detect(survivor, image), expected));
}

TEST(SiftGpuPlugin, TwoInTwoThreadsAnswerAsEachAlone) {
  constexpr int kRounds = 5;
  const std::vector<Image> images{texture(120, 90, 85), texture(100, 110, 86)};
  std::vector<PluginAnswer> alone;
  for (const Image& image : images) {
    PluginUnderTest plugin("detectors/sift_gpu");
    alone.push_back(detect(plugin, image));
  }
  std::vector<std::vector<PluginAnswer>> together(images.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < images.size(); ++i) {
    threads.emplace_back([&, i] {
      PluginUnderTest plugin("detectors/sift_gpu");
      for (int round = 0; round < kRounds; ++round) {
        together[i].push_back(detect(plugin, images[i]));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < images.size(); ++i) {
    ASSERT_EQ(together[i].size(), to_index(kRounds));
    for (const PluginAnswer& outcome : together[i]) {
      EXPECT_TRUE(same_keypoints(outcome, alone[i]));
    }
  }
}

}  // namespace
}  // namespace weft::sift_gpu
