// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <weft/data/image.hpp>
#include <weft/testing/mistakes.hpp>

#include "images_source.hpp"

namespace weft::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// 0 in the left three columns, elsewhere one of the values that masks have.
cv::Mat mask_of(const cv::Size& size, int type = CV_8UC1) {
  cv::Mat mask(size, type, cv::Scalar(0));
  mask.colRange(3, size.width).setTo(cv::Scalar(255));
  mask(cv::Rect(4, 0, 2, 2)).setTo(cv::Scalar(1));
  return mask;
}

/// Two frames, each with a mask.
void write_masks(const FrameFolder& folder) {
  folder.write_camera();
  for (const char* stem : {"a", "b"}) {
    folder.write_frame(std::string("frames/") + stem + ".png");
    folder.write_image(std::string("masks/") + stem + ".png", mask_of({8, 6}));
  }
}

PluginUnderTest with_masks(const FrameFolder& folder) {
  return images_source(folder, "frames/*.png", "region: '" + folder.path("masks/*.png") + "'");
}

int wrong_pixels(const Region& region) {
  int wrong = 0;
  for (std::int64_t y = 0; y < region.mask.dim(0); ++y) {
    for (std::int64_t x = 0; x < region.mask.dim(1); ++x) {
      wrong += region.mask(y, x) != (x >= 3 ? 1 : 0);
    }
  }
  return wrong;
}

TEST(Regions, AreWhereTheMaskOfTheFrameIsNotZero) {
  for (const int type : {CV_8UC1, CV_16UC1}) {
    const FrameFolder folder;
    write_masks(folder);
    folder.write_image("masks/b.png", mask_of({8, 6}, type));
    auto source = with_masks(folder);
    const PluginAnswer opened = source.process(kOpen, {});
    ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
    const auto region = source.process(kRead, {}, 1).get<Region>();
    ASSERT_TRUE(region.has_value());
    EXPECT_EQ(region->mask.dim(0), 6);
    EXPECT_EQ(region->mask.dim(1), 8);
    EXPECT_EQ(wrong_pixels(*region), 0);
  }
}

TEST(Regions, AreAbsentWithoutMasks) {
  const FrameFolder folder;
  write_masks(folder);
  auto source = images_source(folder);
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  EXPECT_FALSE(source.process(kRead, {}, 0).get<Region>().has_value());
}

TEST(Regions, GoThroughTheLensAsTheirImagesDo) {
  const FrameFolder folder;
  constexpr int kWidth = 160, kHeight = 120;
  folder.write("camera.yaml",
               "{fx: 120, fy: 120, cx: 79.5, cy: 59.5, width: 160, height: 120, distortion: [-0.3, "
               "0.05, 0, 0, 0]}");
  cv::Mat half(kHeight, kWidth, CV_8UC1, cv::Scalar(0));
  half.rowRange(20, 100).colRange(30, 130).setTo(cv::Scalar(255));
  folder.write_image("frames/a.png", half);
  folder.write_image("masks/a.png", half);
  auto source = with_masks(folder);
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  const PluginAnswer read = source.process(kRead, {}, 0);
  const auto region = read.get<Region>();
  const auto image = read.get<Image>();
  ASSERT_TRUE(region && image) << read.message;
  int inside = 0, wrong = 0;
  for (std::int64_t y = 0; y < kHeight; ++y) {
    for (std::int64_t x = 0; x < kWidth; ++x) {
      inside += region->mask(y, x);
      // Bilinear values of the image give the same side, except those near the middle.
      const int level = image->pixels(y, x);
      if (level < 100 || level > 155) wrong += (level > 127) != (region->mask(y, x) == 1);
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(inside, 80 * 100) << "the lens had made it smaller";
}

TEST(Regions, OfAFrameWithoutAMaskAreRefusedBeforeAnythingRuns) {
  const FrameFolder folder;
  write_masks(folder);
  folder.write_frame("frames/c.png");
  const PluginAnswer opened = with_masks(folder).process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_ERROR);
  EXPECT_THAT(opened.message, AllOf(HasSubstr("the frame 'c' has no mask"), HasSubstr("add one")));
  EXPECT_THAT(mistakes_of("sources/images", "{path: '" + folder.path("frames/*.png") +
                                                "', camera: '" + folder.path("camera.yaml") +
                                                "', region: '" + folder.path("masks/*.png") + "'}"),
              ElementsAre(HasSubstr("region: the frame 'c' has no mask")));
}

TEST(Regions, OfAMaskWithoutAFrameAreRefused) {
  const FrameFolder folder;
  write_masks(folder);
  folder.write_image("masks/c.png", mask_of({8, 6}));
  EXPECT_THAT(with_masks(folder).process(kOpen, {}).message,
              HasSubstr("c.png: belongs to no frame: no image has the stem 'c'"));
}

TEST(Regions, OfAFileThatIsNoMaskOfTheCameraFailTheirFrame) {
  const FrameFolder folder;
  write_masks(folder);
  auto source = with_masks(folder);
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  const auto message = [&](const cv::Mat& image) {
    folder.write_image("masks/b.png", image);
    const PluginAnswer read = source.process(kRead, {}, 1);
    EXPECT_EQ(read.status, WEFT_ERROR);
    return read.message;
  };
  EXPECT_THAT(message(mask_of({7, 6})), HasSubstr("b.png: is 7 x 6 px, but"));
  EXPECT_THAT(message(cv::Mat(6, 8, CV_8UC3, cv::Scalar::all(1))),
              AllOf(HasSubstr("b.png: a mask has one channel"), HasSubstr("has 3")));
  folder.write("masks/b.png", "no image");
  EXPECT_THAT(source.process(kRead, {}, 1).message, HasSubstr("no image that can be decoded"));
  EXPECT_EQ(source.process(kRead, {}, 0).status, WEFT_OK);
}

}  // namespace
}  // namespace weft::testing
