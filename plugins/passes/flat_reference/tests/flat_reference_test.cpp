// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "print_scene.hpp"

namespace weft::flat_reference {
namespace {

using ::testing::HasSubstr;

class FlatReference : public PrintScene {};

TEST_F(FlatReference, FindsEachWordAtItsPlaceThroughTheTrueMesh) {
  const Registration made = measured(mesh(), with_words());
  ASSERT_EQ(made.count(), std::ssize(words));
  for (std::int64_t i = 0; i < made.count(); ++i) {
    EXPECT_EQ(made.found(i), 1);
    EXPECT_GT(made.correlation(i), 0.99);
    EXPECT_EQ(made.displacement_mm(i, 0), 0.0);
    EXPECT_EQ(made.displacement_mm(i, 1), 0.0);
    const Box& box = words[static_cast<std::size_t>(i)];
    EXPECT_EQ(made.place_px(i, 0), box.left + 0.5 * (box.width - 1));
    EXPECT_EQ(made.place_px(i, 1), box.top + 0.5 * (box.height - 1));
  }
}

TEST_F(FlatReference, MeasuresByHowManyMillimetresTheMeshIsMoved) {
  const Registration made = measured(mesh(6.0, -4.0), with_words());
  ASSERT_EQ(found_in(made), std::ssize(words));
  for (std::int64_t i = 0; i < made.count(); ++i) {
    EXPECT_DOUBLE_EQ(made.displacement_mm(i, 0), -3.0);
    EXPECT_DOUBLE_EQ(made.displacement_mm(i, 1), 2.0);
  }
}

TEST_F(FlatReference, SearchesNoFurtherThanItsRange) {
  const Registration near = measured(mesh(12.0), with_words(", range_mm: 5.9"));
  for (std::int64_t i = 0; i < near.count(); ++i) {
    if (near.found(i) == 0) continue;
    EXPECT_GE(near.displacement_mm(i, 0), -5.5) << "11 texels are the most";
    EXPECT_LT(near.correlation(i), 0.9);
  }
  const Registration far = measured(mesh(12.0), with_words(", range_mm: 6.1"));
  EXPECT_EQ(found_in(far), std::ssize(words));
  for (std::int64_t i = 0; i < far.count(); ++i) {
    EXPECT_DOUBLE_EQ(far.displacement_mm(i, 0), -6.0);
  }
}

TEST_F(FlatReference, CountsWhatCorrelatesBelowTheThresholdAsNotFound) {
  photograph(print_of(words, kSeed + 1));
  const Registration strict = measured(mesh(), with_words());
  EXPECT_LE(found_in(strict), 1);
  EXPECT_EQ(strict.count(), std::ssize(words));
  const Registration lax = measured(mesh(), with_words(", threshold: 0"));
  EXPECT_EQ(found_in(lax), std::ssize(words));
  for (std::int64_t i = 0; i < strict.count(); ++i) {
    EXPECT_EQ(std::isnan(strict.displacement_mm(i, 0)), strict.found(i) == 0);
  }
}

TEST_F(FlatReference, DoesNotFindWordsInAnImageWithoutContrast) {
  std::fill_n(image.pixels.data(), image.pixels.size(), std::uint8_t{200});
  const Registration made = measured(mesh(), with_words());
  EXPECT_EQ(found_in(made), 0);
  EXPECT_EQ(made.count(), std::ssize(words));
}

TEST_F(FlatReference, DoesNotFindWordsThatTheMeshPutsOutsideOfTheImage) {
  const Registration made = measured(mesh(2000.0), with_words());
  EXPECT_EQ(found_in(made), 0);
  EXPECT_EQ(made.count(), std::ssize(words));
}

TEST_F(FlatReference, DoesNotFindWordsThatTheMeshPutsBehindTheCamera) {
  Shape behind = mesh();
  for (std::int64_t v = 0; v < behind.vertices_m.rows(); ++v) behind.vertices_m(v, 2) = -0.6;
  const Registration made = measured(behind, with_words());
  EXPECT_EQ(found_in(made), 0);
}

TEST_F(FlatReference, DoesNotCountBlankWords) {
  const auto all = std::ssize(words);
  words.push_back({500, 3, 20, 10});
  EXPECT_EQ(measured(mesh(), with_words()).count(), all);
}

TEST_F(FlatReference, SearchesCellsWithContrastWhereNoWordsAreGiven) {
  std::vector<Box> left;
  for (const Box& box : words) {
    if (box.left < 200) left.push_back(box);
  }
  templ.texture = print_of(left, kSeed);
  photograph(templ.texture);
  const Registration made = measured(mesh(3.0), "{cell_mm: 20}");
  // Without those that hold a block or two, which the texture repeats.
  ASSERT_GT(made.count(), 15);
  int away_from_border = 0, found = 0;
  for (std::int64_t i = 0; i < made.count(); ++i) {
    EXPECT_LT(made.place_px(i, 0), 260.0);
    // Patches at the left border cannot be found beyond it.
    if (made.place_px(i, 0) < 40.0) continue;
    ++away_from_border;
    if (made.found(i) == 0) continue;
    ++found;
    EXPECT_DOUBLE_EQ(made.displacement_mm(i, 0), -1.5);
  }
  EXPECT_GT(found, 0.9 * away_from_border);
}

TEST_F(FlatReference, MeasuresColourAsItMeasuresGrey) {
  const Array<std::uint8_t> grey = image.pixels;
  image.pixels = Array<std::uint8_t>({grey.dim(0), grey.dim(1), 3}, 0);
  for (std::int64_t i = 0; i < grey.size(); ++i) {
    std::fill_n(image.pixels.data() + 3 * i, 3, grey.data()[i]);
  }
  const Registration made = measured(mesh(2.0), with_words());
  ASSERT_EQ(found_in(made), std::ssize(words));
  EXPECT_DOUBLE_EQ(made.displacement_mm(0, 0), -1.0);
}

TEST_F(FlatReference, HasNoResultWhereTheTextureIsBlank) {
  std::fill_n(templ.texture.data(), templ.texture.size(), std::uint8_t{255});
  const auto grid = answer(mesh(), "{}");
  EXPECT_EQ(grid.status, WEFT_NO_RESULT);
  EXPECT_THAT(grid.message, HasSubstr("no cell of the texture has contrast"));
  const auto listed = answer(mesh(), with_words());
  EXPECT_EQ(listed.status, WEFT_NO_RESULT);
  EXPECT_THAT(listed.message, HasSubstr("another texture"));
}

TEST_F(FlatReference, DoesNotSearchCellsOfALineWhichLookAlike) {
  templ.texture = print_of({}, kSeed);
  for (std::int64_t v = 0; v < kPrintHeightPx; ++v) {
    std::fill_n(templ.texture.row(v) + 200, 4, std::uint8_t{0});
  }
  photograph(templ.texture);
  const auto out = answer(mesh(), "{}");
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_THAT(out.message, HasSubstr("is unique in its surroundings"));
}

TEST_F(FlatReference, NeedsTheTexelPitchForMillimetres) {
  templ.m_per_px = {};
  const auto out = answer(mesh(), with_words());
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, HasSubstr("m_per_px"));
}

TEST_F(FlatReference, NeedsImageAndShape) {
  testing::PluginUnderTest plugin("passes/flat_reference");
  const auto no_shape =
      plugin.process(0, {testing::input("template", templ), testing::input("camera", camera),
                         testing::input("image", image)});
  EXPECT_EQ(no_shape.status, WEFT_ERROR);
  EXPECT_THAT(no_shape.message, HasSubstr("shape"));
  const auto no_image =
      plugin.process(0, {testing::input("template", templ), testing::input("camera", camera),
                         testing::input("shape", mesh())});
  EXPECT_EQ(no_image.status, WEFT_ERROR);
  EXPECT_THAT(no_image.message, HasSubstr("image"));
}

TEST_F(FlatReference, RefusesTheShapeOfAnotherTemplate) {
  Shape other = mesh();
  other.vertices_m = Array<double>({4, 3}, 0.5);
  other.source = Array<std::uint8_t>({4}, 0);
  const auto out = answer(other, with_words());
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, HasSubstr("4"));
}

TEST_F(FlatReference, RefusesATemplateWithoutTexture) {
  templ.texture = Array<std::uint8_t>({0, 0}, 0);
  templ.mask = Array<std::uint8_t>({0, 0}, 0);
  const auto out = answer(mesh(), "{}");
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, HasSubstr("no texture"));
}

}  // namespace
}  // namespace weft::flat_reference
