// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <vector>
#include <weft/core/index.hpp>

#include "common/tests/scenes.hpp"
#include "search.hpp"

namespace weft::sift_fast {
namespace {

/// All that is found in an image.
struct Answer {
  std::vector<Spot> keypoints;
  std::vector<float> descriptors;
};

Answer answer_of(Search& search, const Image& image, int threads) {
  const auto width = static_cast<int>(image.pixels.dim(1));
  const auto height = static_cast<int>(image.pixels.dim(0));
  const auto extrema =
      search.find({image.pixels.data(), image.pixels.row_stride(), width, height}, threads);
  const auto keypoints = search.orient(extrema, threads);
  Answer answer{{keypoints.begin(), keypoints.end()}, {}};
  answer.descriptors.resize(to_index(kDescriptorLength) * keypoints.size());
  search.describe(answer.keypoints, answer.descriptors.data(), threads);
  return answer;
}

bool same(const Answer& a, const Answer& b) {
  const auto equal = [](const Spot& s, const Spot& t) {
    return s.x == t.x && s.y == t.y && s.scale == t.scale && s.angle == t.angle &&
           s.response == t.response && s.octave == t.octave && s.layer == t.layer;
  };
  return std::equal(a.keypoints.begin(), a.keypoints.end(), b.keypoints.begin(), b.keypoints.end(),
                    equal) &&
         a.descriptors == b.descriptors;
}

/// Images with repeated parts, so that many differences are equal, and of the largest contrast.
std::vector<Image> images() {
  return {detectors::texture(333, 241, 71), detectors::texture(64, 50, 72),
          detectors::image_of(200, 120, [](double x, double y) {
            return (static_cast<int>(x) / 7 + static_cast<int>(y) / 9) % 2 == 0 ? 0.0 : 255.0;
          })};
}

std::vector<Settings> settings() {
  std::vector<Settings> all(3);
  all[1].upsample = false;
  all[2].octave_layers = 5;
  all[2].sigma_px = 2.2;
  return all;
}

TEST(SiftFastSameness, TheBitsAreThoseOfOneThreadForAnyNumberOfThem) {
  for (const Settings& each : settings()) {
    Search alone(each), shared(each);
    for (const Image& image : images()) {
      const Answer expected = answer_of(alone, image, 1);
      EXPECT_GT(expected.keypoints.size(), 10U);
      for (const int threads : {2, 4, 1, 3}) {
        for (int i = 0; i < 5; ++i) {
          EXPECT_TRUE(same(answer_of(shared, image, threads), expected)) << threads << " threads";
        }
      }
    }
  }
}

TEST(SiftFastSameness, AnImageGivesTheSameWhateverImageWasBefore) {
  // A refinement that walks far reads rows that its strip does not need.
  Search used{Settings{}};
  for (std::uint64_t seed = 100; seed < 108; ++seed) {
    const Image image = detectors::texture(640, 480, seed);
    Search fresh{Settings{}};
    const Answer expected = answer_of(fresh, image, 1);
    for (const int threads : {1, 2}) {
      EXPECT_TRUE(same(answer_of(used, image, threads), expected))
          << "seed " << seed << ", " << threads << " threads";
    }
  }
}

/// Lets Highway choose among all instructions again.
class Instructions : public ::testing::Test {
 protected:
  ~Instructions() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_F(Instructions, OfEverySetGiveTheSameBits) {
  const std::int64_t all = hwy::SupportedTargets();
  std::vector<std::vector<Answer>> answers;
  for (std::int64_t rest = all; rest != 0; rest &= rest - 1) {
    const std::int64_t target = rest & -rest;
    hwy::SetSupportedTargetsForTest(target);
    std::vector<Answer>& of_target = answers.emplace_back();
    std::size_t keypoints = 0;
    for (const Settings& each : settings()) {
      Search search(each);
      for (const Image& image : images()) {
        of_target.push_back(answer_of(search, image, 1));
        keypoints += of_target.back().keypoints.size();
      }
    }
    std::printf("%s: %d keypoints\n", hwy::TargetName(target), static_cast<int>(keypoints));
  }
  for (std::size_t t = 1; t < answers.size(); ++t) {
    for (std::size_t i = 0; i < answers[t].size(); ++i) {
      EXPECT_TRUE(same(answers[t][i], answers[0][i])) << "set " << t << ", answer " << i;
    }
  }
}

}  // namespace
}  // namespace weft::sift_fast
