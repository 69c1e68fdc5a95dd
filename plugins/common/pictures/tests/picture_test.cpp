// SPDX-License-Identifier: Apache-2.0
#include "common/pictures/picture.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace weft::pictures {
namespace {

TEST(ReadGrey, WeighsTheColoursOfEachPixelOfAnyWidth) {
  for (int width = 1; width <= 23; ++width) {
    // The exact size: AddressSanitizer would report a read beyond it.
    std::vector<std::uint8_t> bytes(to_index(2 * 3 * width));
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(37 * i + 5);
    Picture grey;
    read_grey(Array<std::uint8_t>::borrow(bytes.data(), 3, {2, width, 3}, 3 * width), grey);
    ASSERT_EQ(grey.width, width);
    for (int i = 0; i < 2 * width; ++i) {
      const std::uint8_t* bgr = bytes.data() + 3 * i;
      const float expected = 0.114F * static_cast<float>(bgr[0]) +
                             0.587F * static_cast<float>(bgr[1]) +
                             0.299F * static_cast<float>(bgr[2]);
      EXPECT_EQ(grey.values[to_index(i)], expected) << "pixel " << i << " of width " << width;
    }
  }
}

}  // namespace
}  // namespace weft::pictures
