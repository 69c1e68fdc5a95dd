// SPDX-License-Identifier: Apache-2.0
#include "caption.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "palette.hpp"

namespace weft::overlay {
namespace {

class CaptionOfAFrame : public ::testing::Test {
 protected:
  CaptionOfAFrame() {
    in_.image = Image{};
    in_.image->stem = "009";
  }

  /// Matches, the first `kept` marked as kept.
  static Correspondences matches(std::int64_t count, std::int64_t kept) {
    Correspondences matches;
    matches.template_px = Array<double>({count, 2}, 0.0);
    matches.image_px = Array<double>({count, 2}, 0.0);
    matches.kept = Array<std::uint8_t>({count}, 0);
    for (std::int64_t i = 0; i < count; ++i) matches.kept(i) = i < kept ? 1 : 0;
    return matches;
  }

  void give_shape(ShapeState state, std::int64_t age_frames, double confidence) {
    in_.shape = Shape{};
    in_.shape->state = static_cast<std::int32_t>(state);
    in_.shape->age_frames = age_frames;
    in_.shape->confidence = confidence;
  }

  weft_call raw_{};
  SinkInput in_{Call(raw_)};
};

TEST_F(CaptionOfAFrame, SaysHowManyMatchesAgreeWithAnEstimatedShape) {
  give_shape(ShapeState::estimated, 0, 0.98);
  in_.shape->diag.set("agreeing_matches", 563.0);
  in_.shape->diag.set("kept_matches", 580.0);
  in_.time = Time{0.27};
  const Caption caption = caption_of(in_);
  EXPECT_EQ(caption.state, "estimated");
  EXPECT_EQ(caption.reason, "563 of 580 matches agree with it");
  EXPECT_EQ(caption.place, "frame 009   0.27 s");
  EXPECT_EQ(caption.confidence, 0.98);
}

TEST_F(CaptionOfAFrame, SaysHowManyMatchesWereKeptWhereTheSolverCountsNone) {
  give_shape(ShapeState::estimated, 0, 1.0);
  EXPECT_EQ(caption_of(in_).reason, "");
  in_.correspondences = matches(3, 1);
  EXPECT_EQ(caption_of(in_).reason, "1 match kept");
}

TEST_F(CaptionOfAFrame, WarnsOfAWeakShape) {
  give_shape(ShapeState::weak, 0, 0.3);
  in_.correspondences = matches(30, 12);
  EXPECT_EQ(caption_of(in_).state, "weak");
  EXPECT_EQ(caption_of(in_).reason, "it may be wrong; 12 matches kept");
}

TEST_F(CaptionOfAFrame, SaysHowOldAShapeIsAndWhatThereWasToGoBy) {
  give_shape(ShapeState::predicted, 1, 0.0);
  EXPECT_EQ(caption_of(in_).state, "predicted");
  EXPECT_EQ(caption_of(in_).reason, "as it was 1 frame ago; no match was kept");
  give_shape(ShapeState::lost, 31, 0.0);
  in_.correspondences = matches(30, 12);
  EXPECT_EQ(caption_of(in_).state, "lost");
  EXPECT_EQ(caption_of(in_).reason,
            "as it was 31 frames ago; 12 matches kept, but no shape was found for them");
}

TEST_F(CaptionOfAFrame, SaysThatThereIsNoShape) {
  in_.image->stem.clear();
  raw_.frame = 7;
  const Caption caption = caption_of(in_);
  EXPECT_EQ(caption.state, "no result");
  EXPECT_EQ(caption.reason, "no match was kept");
  EXPECT_EQ(caption.place, "frame 7");
  EXPECT_EQ(caption.confidence, std::nullopt);
}

TEST(Caption, MarksTheConfidenceOnItsScale) {
  // The mark is the darkest column of the bar, and moves with the value.
  const auto mark_of = [](double confidence) {
    cv::Mat strip(70, 1000, CV_8UC3);
    draw_caption(strip, {"estimated", "", "", confidence});
    int darkest = 0, mark = 0;
    for (int x = 800; x < strip.cols; ++x) {
      int dark = 0;
      for (int y = 15; y < 35; ++y) dark += strip.at<cv::Vec3b>(y, x)[1] < 60 ? 1 : 0;
      if (dark > darkest) {
        darkest = dark;
        mark = x;
      }
    }
    return mark;
  };
  const int none = mark_of(0.0), half = mark_of(0.5), full = mark_of(1.0);
  EXPECT_GT(full, none + 100);
  EXPECT_NEAR(half, 0.5 * (none + full), 2.0);
}

TEST(ConfidenceColour, IsDistinguishableWithoutRedAndGreen) {
  // The amount of blue alone shows it.
  double before = -1.0;
  for (double confidence = 0.0; confidence <= 1.0; confidence += 0.125) {
    const double blue = colour_of_confidence(confidence)[0];
    EXPECT_GT(blue, before + 10.0) << confidence;
    before = blue;
  }
  EXPECT_EQ(colour_of_confidence(std::nan("")), colour_of_confidence(0.0));
  EXPECT_EQ(colour_of_confidence(7.0), colour_of_confidence(1.0));
}

}  // namespace
}  // namespace weft::overlay
