// SPDX-License-Identifier: Apache-2.0
#include "nearest_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <weft/core/index.hpp>

#include "common/distances/coarse_hamming.hpp"
#include "common/distances/coarse_l2.hpp"
#include "common/tests/keypoints_of.hpp"

namespace weft::descriptor {
namespace {

using matchers::CoarseDistances;
using matchers::CoarseHamming;
using matchers::CoarseL2;
using matchers::random_bytes;
using matchers::random_descriptors;

constexpr auto kNever = [] { return false; };

Array<double> random_places(int count, double side_px, Rng& rng) {
  Array<double> places({count, 2}, 0.0);
  for (std::int64_t i = 0; i < places.size(); ++i) places.data()[i] = rng.uniform(0.0, side_px);
  return places;
}

/// Scans all pairs, as in the definition; the lowest index wins ties.
std::vector<Nearest> scan(const CoarseDistances& distances, const Array<double>& places,
                          const NearestSearch::Options& options) {
  std::vector<Nearest> all;
  for (int i = 0; i < distances.queries(); ++i) {
    Nearest found;
    for (int j = 0; j < distances.trains(); ++j) {
      const double distance = distances.distance(i, j);
      if (found.best < 0 || distance < found.distance) {
        found.best = j;
        found.distance = distance;
      }
    }
    for (int j = 0; j < distances.trains(); ++j) {
      const double gap_px =
          std::hypot(places(j, 0) - places(found.best, 0), places(j, 1) - places(found.best, 1));
      if (j == found.best || (options.elsewhere_px > 0.0 && gap_px <= options.elsewhere_px))
        continue;
      const double distance = distances.distance(i, j);
      if (found.second < 0 || distance < found.second_distance) {
        found.second = j;
        found.second_distance = distance;
      }
    }
    if (options.mutual) {
      for (int other = 0; other < distances.queries(); ++other) {
        const double theirs = distances.distance(other, found.best);
        if (theirs < found.distance || (theirs == found.distance && other < i)) found.second = -1;
      }
    }
    all.push_back(found);
  }
  return all;
}

/// Compares queries with two neighbours whose distance is below `ratio` times the second one.
void expect_same(const std::vector<Nearest>& found, const std::vector<Nearest>& expected,
                 double ratio) {
  ASSERT_EQ(found.size(), expected.size());
  const auto passes = [ratio](const Nearest& nearest) {
    return nearest.second >= 0 && nearest.distance < ratio * nearest.second_distance;
  };
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(passes(found[i]), passes(expected[i])) << i;
    if (!passes(expected[i])) continue;
    ASSERT_EQ(found[i].best, expected[i].best) << i;
    ASSERT_EQ(found[i].second, expected[i].second) << i;
    ASSERT_EQ(found[i].distance, expected[i].distance) << i;
    ASSERT_EQ(found[i].second_distance, expected[i].second_distance) << i;
  }
}

void expect_as_scan(CoarseDistances& distances, const Array<double>& places) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double elsewhere_px : {0.0, 5.0, 1000.0}) {
    for (const bool mutual : {false, true}) {
      NearestSearch::Options options{.elsewhere_px = elsewhere_px, .mutual = mutual};
      const std::vector<Nearest> expected = scan(distances, places, options);
      for (const double ratio : {kInfinity, 1.0, 0.8}) {
        options.ratio = ratio;
        NearestSearch search;
        ASSERT_TRUE(search.run(distances, places, options, kNever));
        expect_same(search.nearest(), expected, ratio);
      }
    }
  }
}

/// A third of the trains are queries that changed a little, some are queries and trains again.
Array<float> related(const Array<float>& queries, int count, Rng& rng) {
  Array<float> trains = random_descriptors(count, queries.dim(1), rng);
  for (std::int64_t j = 0; j < count; ++j) {
    const bool is_copy = j % 20 == 0;
    if (j % 3 != 0 && !is_copy) continue;
    const std::int64_t from = j % queries.dim(0);
    for (std::int64_t k = 0; k < queries.dim(1); ++k) {
      const double noise = is_copy ? 0.0 : std::floor(rng.uniform(0.0, 20.0));
      trains(j, k) = queries(from, k) + static_cast<float>(noise);
    }
  }
  return trains;
}

TEST(NearestSearch, FindsTheSameAsAScanOfAllPairsAmongBits) {
  std::printf("seed 5\n");
  Rng rng(5);
  const Array<std::uint8_t> a = random_bytes(60, 3, rng);  // few bits: many ties
  const Array<std::uint8_t> b = random_bytes(300, 3, rng);
  CoarseHamming distances;
  distances.load(a, b);
  expect_as_scan(distances, random_places(300, 40.0, rng));
}

TEST(NearestSearch, FindsTheSameAsAScanOfAllPairsAmongNumbers) {
  std::printf("seed 6\n");
  Rng rng(6);
  for (const int length : {2, 31, 128}) {
    const Array<float> a = random_descriptors(70, length, rng);
    const Array<float> b = related(a, 210, rng);
    CoarseL2 distances;
    for (const bool root : {false, true}) {
      distances.load(a, b, root);
      expect_as_scan(distances, random_places(210, 40.0, rng));
    }
  }
}

TEST(NearestSearch, FindsTheSameWhereOneDescriptorDwarfsAllOthers) {
  Rng rng(7);
  Array<float> a = random_descriptors(40, 16, rng), b = related(a, 90, rng);
  b(89, 0) = 1e9F;  // all others are rounded to nothing
  a(3, 1) = -1e9F;
  CoarseL2 distances;
  distances.load(a, b, false);
  expect_as_scan(distances, random_places(90, 40.0, rng));
}

TEST(NearestSearch, FindsTheSameAmongEqualDescriptors) {
  Rng rng(8);
  Array<float> same({50, 8}, 0.0F);
  for (std::int64_t i = 0; i < same.size(); ++i) same.data()[i] = 3.0F;
  CoarseL2 distances;
  distances.load(same, same, true);
  expect_as_scan(distances, random_places(50, 20.0, rng));
}

TEST(NearestSearch, DoesNotDependOnThreadsOrOnTheOrderOfTrains) {
  Rng rng(9);
  constexpr int kTrains = 400;
  const Array<float> a = random_descriptors(150, 128, rng), b = related(a, kTrains, rng);
  const Array<double> places = random_places(kTrains, 100.0, rng);
  NearestSearch search;
  CoarseL2 distances;
  distances.load(a, b, true);
  NearestSearch::Options options{.elsewhere_px = 3.0, .mutual = true};
  ASSERT_TRUE(search.run(distances, places, options, kNever));
  const std::vector<Nearest> one = search.nearest();
  for (const int threads : {2, 4, 1}) {
    options.threads = threads;
    ASSERT_TRUE(search.run(distances, places, options, kNever));
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(search.nearest()[i].best, one[i].best) << threads;
      ASSERT_EQ(search.nearest()[i].second, one[i].second) << threads;
      ASSERT_EQ(search.nearest()[i].second_distance, one[i].second_distance) << threads;
    }
  }
}

TEST(NearestSearch, WithoutQueriesOrWithOneTrainThereIsNothingToCompare) {
  Rng rng(10);
  CoarseL2 distances;
  NearestSearch search;
  const Array<float> none({0, 8}, 0.0F), one = random_descriptors(1, 8, rng);
  const Array<float> five = random_descriptors(5, 8, rng);
  distances.load(none, five, false);
  EXPECT_TRUE(search.run(distances, random_places(5, 9.0, rng), {.mutual = true}, kNever));
  EXPECT_TRUE(search.nearest().empty());
  distances.load(five, one, false);
  EXPECT_TRUE(search.run(distances, random_places(1, 9.0, rng), {}, kNever));
  EXPECT_EQ(search.nearest()[4].best, 0);
  EXPECT_EQ(search.nearest()[4].second, -1);
}

TEST(NearestSearch, StopsWhenCancelled) {
  const Array<std::uint8_t> bytes({100, 4}, 0);
  CoarseHamming distances;
  distances.load(bytes, bytes);
  NearestSearch search;
  int asked = 0;
  EXPECT_FALSE(
      search.run(distances, Array<double>({100, 2}, 0.0), {}, [&] { return ++asked == 2; }));
  EXPECT_EQ(asked, 2);
  EXPECT_FALSE(
      search.run(distances, Array<double>({100, 2}, 0.0), {.threads = 4}, [] { return true; }));
}

}  // namespace
}  // namespace weft::descriptor
