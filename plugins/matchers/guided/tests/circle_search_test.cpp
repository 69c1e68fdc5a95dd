// SPDX-License-Identifier: Apache-2.0
#include "circle_search.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <weft/core/index.hpp>

#include "common/distances/coarse_hamming.hpp"
#include "common/distances/coarse_l2.hpp"
#include "common/tests/keypoints_of.hpp"

namespace weft::guided {
namespace {

using matchers::CoarseDistances;
using matchers::CoarseHamming;
using matchers::CoarseL2;
using matchers::Nearest;
using matchers::random_bytes;
using matchers::random_descriptors;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Every seventh has no place in the image.
SidePlaces random_places(int count, Rng& rng) {
  SidePlaces places;
  for (int i = 0; i < count; ++i) {
    places.in_image.emplace_back(rng.uniform(0, 200), i % 7 == 3 ? kUnknown : rng.uniform(0, 100));
    places.at_home.emplace_back(rng.uniform(0, 50), rng.uniform(0, 50));
  }
  return places;
}

bool in_reach(const SidePlaces& a, int i, const SidePlaces& b, int j, double radius_px) {
  return (a.in_image[to_index(i)] - b.in_image[to_index(j)]).norm() <= radius_px;
}

/// The definition, for one query.
Nearest scan(const CoarseDistances& distances, int query, const SidePlaces& queries,
             const SidePlaces& trains, const CircleSearch::Options& options) {
  Nearest found;
  int count = 0;
  for (int j = 0; j < distances.trains(); ++j) {
    if (!in_reach(queries, query, trains, j, options.radius_px)) continue;
    ++count;
    const double distance = distances.distance(query, j);
    if (found.best < 0 || distance < found.distance) {
      found.best = j;
      found.distance = distance;
    }
  }
  if (found.best < 0) return found;
  const auto compete = [&](int j) {
    const double gap_px =
        (trains.at_home[to_index(j)] - trains.at_home[to_index(found.best)]).norm();
    if (j == found.best || (options.elsewhere_px > 0.0 && gap_px <= options.elsewhere_px)) return;
    const double distance = distances.distance(query, j);
    if (found.second >= 0 && distance >= found.second_distance) return;
    found.second = j;
    found.second_distance = distance;
  };
  for (int j = 0; j < distances.trains(); ++j) {
    if (in_reach(queries, query, trains, j, options.radius_px)) compete(j);
  }
  if (count < options.least_rivals) {
    const int step = distances.trains() / options.least_rivals;
    for (int j = step / 2; j < distances.trains(); j += step) compete(j);
  }
  if (options.mutual) {
    for (int other = 0; other < distances.queries(); ++other) {
      if (!in_reach(queries, other, trains, found.best, options.radius_px)) continue;
      const double theirs = distances.distance(other, found.best);
      if (theirs < found.distance || (theirs == found.distance && other < query)) found.second = -1;
    }
  }
  return found;
}

void expect_as_scan(CoarseDistances& distances, Rng& rng) {
  const SidePlaces queries = random_places(distances.queries(), rng);
  const SidePlaces trains = random_places(distances.trains(), rng);
  for (const double ratio : {0.8, 1.0}) {
    for (const double elsewhere_px : {0.0, 10.0}) {
      for (const int least_rivals : {0, 16}) {
        for (const bool mutual : {false, true}) {
          for (const double radius_px : {3.0, 30.0, 1000.0}) {
            CircleSearch::Options options{radius_px, elsewhere_px, least_rivals, ratio, mutual};
            CircleSearch search;
            const std::vector<Nearest> found = search.run(distances, queries, trains, options);
            options.threads = 2;
            const auto& by_two = search.run(distances, queries, trains, options);
            ASSERT_EQ(found.size(), to_index(distances.queries()));
            for (int i = 0; i < distances.queries(); ++i) {
              const Nearest expected = scan(distances, i, queries, trains, options);
              const Nearest& got = found[to_index(i)];
              ASSERT_EQ(by_two[to_index(i)].best, got.best) << i;
              ASSERT_EQ(by_two[to_index(i)].second, got.second) << i;
              const auto passes = [ratio](const Nearest& nearest) {
                return nearest.second >= 0 && nearest.distance < ratio * nearest.second_distance;
              };
              ASSERT_EQ(passes(got), passes(expected)) << i;
              if (!passes(expected)) continue;
              ASSERT_EQ(got.best, expected.best) << i;
              ASSERT_EQ(got.distance, expected.distance) << i;
              ASSERT_EQ(got.second_distance, expected.second_distance) << i;
            }
          }
        }
      }
    }
  }
}

TEST(CircleSearch, FindsTheSameAsAScanOfAllPairs) {
  std::printf("seed 1\n");
  Rng rng(1);
  CoarseL2 l2;
  const Array<float> a = random_descriptors(60, 32, rng);
  Array<float> b = random_descriptors(150, 32, rng);
  for (int j = 0; j < 50; ++j) {
    for (int k = 0; k < 32; ++k) b(j, k) = a(j, k) + static_cast<float>(rng.below(20));
  }
  l2.load(a, b, true);
  expect_as_scan(l2, rng);
  CoarseHamming hamming;  // few bits: many ties
  hamming.load(random_bytes(60, 2, rng), random_bytes(150, 2, rng));
  expect_as_scan(hamming, rng);
}

TEST(CircleSearch, FindsNothingWhereNothingIsPlaced) {
  Rng rng(2);
  CoarseL2 distances;
  const Array<float> a = random_descriptors(4, 8, rng), b = random_descriptors(5, 8, rng);
  distances.load(a, b, false);
  const SidePlaces nowhere{std::vector<Eigen::Vector2d>(5, {kUnknown, kUnknown}),
                           std::vector<Eigen::Vector2d>(5, {0, 0})};
  CircleSearch search;
  for (const Nearest& found : search.run(distances, nowhere, nowhere, {.least_rivals = 3})) {
    EXPECT_EQ(found.best, -1);
  }
}

TEST(CircleSearch, ALoneCandidateIsComparedWithRivalsFromAllOver) {
  Array<float> query({1, 4}, 0.0F), trains({3, 4}, 0.0F);
  query(0, 0) = 100.0F;
  trains(0, 0) = 100.0F;
  trains(0, 1) = 10.0F;
  for (int j = 1; j < 3; ++j) trains(j, 2) = 100.0F;
  CoarseL2 distances;
  const SidePlaces here{{{10, 10}}, {{0, 0}}};
  const SidePlaces there{{{12, 10}, {400, 10}, {400, 20}}, {{12, 10}, {400, 10}, {400, 20}}};
  CircleSearch search;
  distances.load(query, trains, false);
  EXPECT_EQ(search.run(distances, here, there, {})[0].second, -1) << "nothing to compare with";
  const Nearest found = search.run(distances, here, there, {.least_rivals = 3})[0];
  EXPECT_EQ(found.best, 0);
  EXPECT_DOUBLE_EQ(found.second_distance, 100.0 * std::sqrt(2.0));
  trains(2, 0) = 99.0F;  // far away, and more like it
  trains(2, 2) = 0.0F;
  distances.load(query, trains, false);
  const Nearest beaten = search.run(distances, here, there, {.least_rivals = 3})[0];
  EXPECT_GT(beaten.distance, beaten.second_distance);
}

}  // namespace
}  // namespace weft::guided
