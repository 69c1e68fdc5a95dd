// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <weft/data/image.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace {

using namespace weft::testing;

/// Grey levels 0, 1, 2, ... 255 in 16 rows.
weft::Image all_grey_levels() {
  weft::Image image;
  image.pixels = weft::Array<std::uint8_t>({16, 16});
  for (std::int64_t i = 0; i < 256; ++i) image.pixels.data()[i] = static_cast<std::uint8_t>(i);
  image.stem = "levels";
  return image;
}

TEST(MyPluginStage, LeavesOutWhatIsDarkerAndWhatIsBrighter) {
  PluginUnderTest stage("stages/my_plugin", "{darkest: 20, brightest: 200}");
  const PluginAnswer answer = stage.process(0, {input("image", all_grey_levels())});
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  const auto region = *answer.get<weft::Region>();
  for (std::int64_t i = 0; i < 256; ++i) {
    EXPECT_EQ(region.mask.data()[i], i >= 20 && i <= 200 ? 1 : 0) << i;
  }
}

TEST(MyPluginStage, SaysThatNothingIsLeft) {
  PluginUnderTest stage("stages/my_plugin", "{darkest: 100, brightest: 50}");
  const PluginAnswer answer = stage.process(0, {input("image", all_grey_levels())});
  EXPECT_EQ(answer.status, WEFT_NO_RESULT);
  EXPECT_EQ(answer.message, "no pixel is bright enough and not too bright");
}

}  // namespace
