// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "tools/insole_photo.hpp"
#include "tools/sheet_map.hpp"
#include "tools/sole_print.hpp"
#include "tools/weak_print.hpp"

namespace weft::texture {
namespace {

/// Checks that a file of the repository is what the program draws.
template <class Draw>
void expect_drawn(const std::string& file, const Draw& draw) {
  const cv::Mat stored = cv::imread(WEFT_TEXTURES + file, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(stored.type(), CV_8U) << file;
  const std::vector<std::uint8_t> drawn = draw(stored.cols, stored.rows, 21).pixels();
  ASSERT_EQ(drawn.size(), stored.total());
  int worst = 0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    worst = std::max(worst, std::abs(int{drawn[i]} - int{stored.data[i]}));
  }
  EXPECT_LE(worst, 1) << file;  // compilers may round differently
}

TEST(Textures, AreWhatTheProgramDraws) {
  expect_drawn("sheet_texture.png", draw_map);
  expect_drawn("weak_texture.png", draw_weak_print);
  expect_drawn("sole_texture.png", draw_sole_print);
  expect_drawn("insole.png", draw_insole_photo);
}

}  // namespace
}  // namespace weft::texture
