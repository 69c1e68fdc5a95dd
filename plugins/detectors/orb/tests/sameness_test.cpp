// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstring>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/tests/scenes.hpp"
#include "search.hpp"

namespace weft::orb {
namespace {

using detectors::constant_image;
using detectors::texture;

struct Answer {
  std::vector<cv::KeyPoint> keypoints;
  std::vector<std::uint8_t> descriptors;
};

Answer answer_of(Search& search, const Image& image, int threads,
                 const Array<std::uint8_t>* mask = nullptr) {
  const cv::Mat grey(static_cast<int>(image.pixels.dim(0)), static_cast<int>(image.pixels.dim(1)),
                     CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  search.run(grey, mask, threads);
  const cv::Mat& rows = search.descriptors();
  return {search.keypoints(), {rows.datastart, rows.datastart + rows.total()}};
}

bool same(const Answer& a, const Answer& b) {
  const auto equal = [](const cv::KeyPoint& s, const cv::KeyPoint& t) {
    return s.pt == t.pt && s.size == t.size && s.angle == t.angle && s.response == t.response &&
           s.octave == t.octave;
  };
  return std::equal(a.keypoints.begin(), a.keypoints.end(), b.keypoints.begin(), b.keypoints.end(),
                    equal) &&
         a.descriptors == b.descriptors;
}

Array<std::uint8_t> right_half(const Image& image) {
  Array<std::uint8_t> mask({image.pixels.dim(0), image.pixels.dim(1)}, 0);
  for (std::int64_t y = 0; y < mask.dim(0); ++y) {
    for (std::int64_t x = mask.dim(1) / 2; x < mask.dim(1); ++x) mask(y, x) = 1;
  }
  return mask;
}

std::vector<Settings> settings() {
  return {{}, {.max_keypoints = 150, .buckets = 4}, {.max_keypoints = 0, .border_px = 16}};
}

TEST(OrbSameness, TheBitsAreThoseOfOneThreadForAnyNumberOfThem) {
  const Image image = texture(333, 241, 71);
  const Array<std::uint8_t> mask = right_half(image);
  for (const Settings& each : settings()) {
    Search alone(each), shared(each);
    for (const Array<std::uint8_t>* where :
         {static_cast<const Array<std::uint8_t>*>(nullptr), &mask}) {
      const Answer expected = answer_of(alone, image, 1, where);
      EXPECT_GT(expected.keypoints.size(), 100U);
      for (const int threads : {2, 4, 1, 3, 2}) {
        EXPECT_TRUE(same(answer_of(shared, image, threads, where), expected)) << threads;
      }
    }
  }
}

TEST(OrbSameness, AnImageGivesTheSameWhateverImageWasBefore) {
  Search used{Settings{}};
  for (const Image& image : {texture(200, 160, 5), constant_image(200, 160), texture(200, 160, 6),
                             texture(90, 300, 7), constant_image(1, 1), texture(39, 39, 8)}) {
    Search fresh{Settings{}};
    EXPECT_TRUE(same(answer_of(used, image, 2), answer_of(fresh, image, 1)));
  }
}

TEST(OrbSameness, ImagesWithoutRoomBetweenTheBordersHaveNoKeypoints) {
  Search search{Settings{}};
  for (const Image& image : {constant_image(1, 1), texture(38, 200, 9), texture(200, 38, 10)}) {
    EXPECT_TRUE(answer_of(search, image, 4).keypoints.empty());
  }
  EXPECT_TRUE(answer_of(search, constant_image(100, 100), 4).keypoints.empty());
}

TEST(OrbSameness, ACancelledCallEndsOnAnyNumberOfThreadsAndTheNextIsWhole) {
  const Image image = texture(640, 480, 12);
  Search fresh{Settings{}}, search{Settings{}};
  const Answer expected = answer_of(fresh, image, 1);
  for (const int threads : {1, 2, 4}) {
    {
      const StopCheck check([](const void*) { return true; }, nullptr);
      EXPECT_THROW(answer_of(search, image, threads), Stopped);
    }
    EXPECT_TRUE(same(answer_of(search, image, threads), expected)) << threads;
  }
}

/// Lets Highway choose among all instructions again.
class OrbInstructions : public ::testing::Test {
 protected:
  ~OrbInstructions() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_F(OrbInstructions, OfEverySetGiveTheSameBits) {
  const Image image = texture(333, 241, 72);
  Search search{Settings{}};
  const Answer expected = answer_of(search, image, 1);
  for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & -rest);
    EXPECT_TRUE(same(answer_of(search, image, 1), expected)) << hwy::TargetName(rest & -rest);
  }
}

}  // namespace
}  // namespace weft::orb
