// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <weft/core/index.hpp>

#include "search.hpp"
#include "tests/kernel_runner.hpp"
#include "tests/reference_matching.hpp"

namespace weft::sift_gpu {
namespace {

using reference::kRoundoff;
using reference::Plane;
using reference::Rows;
using reference::whole_numbers;

constexpr std::uint64_t kMatchingSeed = 71;

/// Queries and trains: one, one less and one more than a tile, a group or two of them are long.
struct Counts {
  int queries, trains;
};
constexpr Counts kCounts[] = {{1, 1},   {1, 2},   {1, 700}, {700, 1}, {31, 33},
                              {32, 32}, {33, 31}, {64, 65}, {65, 64}, {97, 130}};

/// One element, one less and one more than are loaded at a time, and those of SIFT.
constexpr int kLengths[] = {1, 2, 15, 16, 17, 33, 127, 128, 129};

double difference(float found, double expected, double unit) {
  const double off = std::abs(static_cast<double>(found) - expected);
  return off == 0.0 ? 0.0 : std::isnan(off) ? std::numeric_limits<double>::infinity() : off / unit;
}

/// Runs the kernels of matching as a search does, with guards behind all that they write.
class MatchingKernels : public ::testing::Test {
 protected:
  MatchingKernels() { std::printf("descriptors from seed %d\n", static_cast<int>(kMatchingSeed)); }

  struct Loaded {
    std::vector<float> rows, norms;
  };

  static std::vector<float> guarded(std::vector<float> values) {
    values.resize(values.size() + kGuard, std::numeric_limits<float>::quiet_NaN());
    return values;
  }
  std::vector<float> unguarded(const cl::Buffer& buffer, std::size_t count) {
    std::vector<float> values = runner_.download<float>(buffer, count + kGuard);
    EXPECT_TRUE(std::all_of(values.end() - kGuard, values.end(), [](float v) { return v != v; }));
    values.resize(count);
    return values;
  }

  Loaded load(const cl::Buffer& rows, Eigen::Index count, Eigen::Index length, bool root) {
    const cl::Buffer norms = runner_.upload(guarded(std::vector<float>(to_index(count), -1.0F)));
    runner_.over_items("load", to_index(count), rows, static_cast<int>(count),
                       static_cast<int>(length), root ? 1 : 0, norms);
    return {unguarded(rows, to_index(count * length)), unguarded(norms, to_index(count))};
  }
  Loaded load(const Rows& rows, bool root) {
    return load(runner_.upload(guarded(reference::floats_of(rows))), rows.rows(), rows.cols(),
                root);
  }

  /// For queries from `first` on; [queries - first,trains].
  std::vector<float> distances(const Loaded& queries, int first, const Loaded& trains, int length) {
    const int rows = static_cast<int>(queries.norms.size()) - first;
    const auto columns = static_cast<int>(trains.norms.size());
    const auto tiles = [](int count) { return to_index((count + kTileSide - 1) / kTileSide); };
    const std::size_t count = to_index(rows) * trains.norms.size();
    const cl::Buffer squares = runner_.upload(guarded(std::vector<float>(count, -1.0F)));
    runner_.over_tiles(
        "distances", tiles(rows) * tiles(columns), runner_.upload(guarded(queries.rows)),
        runner_.upload(guarded(queries.norms)), first, rows, runner_.upload(guarded(trains.rows)),
        runner_.upload(guarded(trains.norms)), columns, length, squares);
    return unguarded(squares, count);
  }

  /// From squared distances of the queries from `first` on; expects nothing written for others.
  std::vector<Pair> nearest(const Plane& squares, const std::vector<float>& places,
                            double elsewhere_px, const Rows& queries, const Rows& trains,
                            int first) {
    const Pair untouched{-7, -8, -9.0F, -10.0F};
    const auto begin = to_index(first);
    const std::size_t end = begin + to_index(squares.rows());
    const cl::Buffer pairs = runner_.upload(std::vector<Pair>(end + kGuard, untouched));
    runner_.over_spots(
        "nearest", end - begin, runner_.upload(guarded(reference::floats_of(squares))),
        static_cast<int>(squares.cols()), runner_.upload(guarded(places)),
        static_cast<float>(elsewhere_px), runner_.upload(guarded(reference::floats_of(queries))),
        runner_.upload(guarded(reference::floats_of(trains))), first,
        static_cast<int>(trains.cols()), pairs);
    std::vector<Pair> found = runner_.download<Pair>(pairs, end + kGuard);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const bool outside = i < begin || i >= end;
      EXPECT_EQ(found[i].best == untouched.best, outside) << i;
    }
    return {found.begin() + first, found.end() - kGuard};
  }

  /// In blocks of at most `block` queries.
  std::vector<int> nearest_queries(const Plane& squares, int block) {
    const auto trains = to_index(squares.cols());
    const cl::Buffer best = runner_.upload(std::vector<cl_int>(trains + kGuard, -7));
    const cl::Buffer least = runner_.upload(std::vector<float>(trains + kGuard, kInfinity));
    for (int first = 0; first < squares.rows(); first += block) {
      const int rows = std::min(block, static_cast<int>(squares.rows()) - first);
      runner_.over_items(
          "nearest_queries", trains,
          runner_.upload(guarded(reference::floats_of(squares.middleRows(first, rows)))), first,
          rows, static_cast<int>(trains), least, best);
    }
    std::vector<int> found = runner_.download<int>(best, trains + kGuard);
    EXPECT_EQ(std::count(found.begin(), found.end(), -7), kGuard);
    found.resize(trains);
    return found;
  }

  static constexpr std::ptrdiff_t kGuard = 100;
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();

  KernelRunner runner_;
  Rng rng_{kMatchingSeed};
};

TEST_F(MatchingKernels, WidenTakesEveryByteAndNothingBehindThem) {
  std::vector<std::uint8_t> bytes(300);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  const cl::Buffer to = runner_.upload(guarded(std::vector<float>(bytes.size(), -1.0F)));
  runner_.over_items("widen", bytes.size(), runner_.upload(bytes), static_cast<int>(bytes.size()),
                     to);
  EXPECT_EQ(unguarded(to, bytes.size()), std::vector<float>(bytes.begin(), bytes.end()));
}

TEST_F(MatchingKernels, LoadKeepsBytesOfAnyLengthAndTheirSquaredNormsAreExact) {
  for (int length = 1; length <= 129; ++length) {
    const int count = 1 + length % 67;
    const Rows rows = whole_numbers(count, length, 256, rng_);
    const std::vector<float> floats = reference::floats_of(rows);
    const auto elements = static_cast<int>(floats.size());
    const cl::Buffer wide = runner_.upload(guarded(std::vector<float>(floats.size(), -1.0F)));
    runner_.over_items("widen", floats.size(),
                       runner_.upload(std::vector<std::uint8_t>(floats.begin(), floats.end())),
                       elements, wide);
    const std::vector<float> norms = reference::floats_of(rows.rowwise().squaredNorm());
    for (const Loaded& loaded : {load(wide, count, length, false), load(rows, false)}) {
      EXPECT_EQ(loaded.rows, floats) << length;
      EXPECT_EQ(loaded.norms, norms) << length;
    }
  }
}

TEST_F(MatchingKernels, LoadTakesRootsOfDescriptorsOfAnyLengthAndOfZeros) {
  double element = 0.0, norm = 0.0;
  for (int length = 1; length <= 129; ++length) {
    const int count = 2 + length % 67;
    Rows rows = whole_numbers(count, length, length % 2 == 0 ? 256 : 2, rng_);
    rows.row(0).setZero();
    rows.row(1).setConstant(255.0);
    const Rows expected = reference::rooted(rows);
    const Loaded loaded = load(rows, true);
    // For each element the sum, a division and a root; for the norm those and its sum.
    const double unit = kRoundoff * (length + 10);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index d = 0; d < length; ++d) {
        element = std::max(element, difference(loaded.rows[to_index(i * length + d)],
                                               expected(i, d), unit * expected(i, d)));
      }
      const double of_row = expected.row(i).squaredNorm();
      norm = std::max(norm, difference(loaded.norms[to_index(i)], of_row, unit * of_row));
    }
  }
  std::printf("RootSIFT: of (length + 10) 2^-24, elements differ by %.3f, norms by %.3f\n", element,
              norm);
  EXPECT_LT(element, 1.0);
  EXPECT_LT(norm, 2.0);
}

TEST_F(MatchingKernels, DistancesOfBytesAreExact) {
  // No sum is larger than that of two norms, 2 * 129 * 255^2 < 2^24.
  const auto expect_exact = [&](const Counts& counts, int length) {
    const Rows queries = whole_numbers(counts.queries, length, 256, rng_);
    Rows trains = whole_numbers(counts.trains, length, 256, rng_);
    trains.row(counts.trains / 2) = queries.row(counts.queries / 2);
    trains.row(0).setZero();
    const Plane expected = reference::squared_distances(queries, trains);
    for (const int first : {0, counts.queries / 2}) {
      EXPECT_EQ(distances(load(queries, false), first, load(trains, false), length),
                reference::floats_of(expected.bottomRows(counts.queries - first)))
          << counts.queries << " x " << counts.trains << " of " << length << " from " << first;
    }
  };
  for (const Counts& counts : kCounts) {
    for (const int length : kLengths) expect_exact(counts, length);
  }
  for (int length = 1; length <= 129; ++length) expect_exact({5, 7}, length);
}

TEST_F(MatchingKernels, DistancesOfRootsAreThoseOfTheReferenceToRounding) {
  double largest = 0.0, largest_square = 0.0;
  for (const Counts& counts : kCounts) {
    for (const int length : kLengths) {
      const Rows queries = whole_numbers(counts.queries, length, 256, rng_);
      Rows trains = whole_numbers(counts.trains, length, 256, rng_);
      trains.row(counts.trains / 2) = queries.row(counts.queries / 2);
      const Plane expected =
          reference::squared_distances(reference::rooted(queries), reference::rooted(trains));
      const std::vector<float> found =
          distances(load(queries, true), 0, load(trains, true), length);
      // Two norms of 1 and twice a product of at most 1, each to the rounding of a loaded norm.
      const double unit = kRoundoff * 4.0 * (2.0 * length + 20);
      for (std::size_t n = 0; n < found.size(); ++n) {
        const double square = expected.reshaped<Eigen::RowMajor>()[static_cast<Eigen::Index>(n)];
        largest = std::max(largest, difference(found[n], square, unit));
        largest_square = std::max(largest_square, difference(found[n], square, 1.0));
      }
    }
  }
  std::printf("squared distances of roots differ by %.2g, %.3f of the bound\n", largest_square,
              largest);
  EXPECT_LT(largest, 1.0);
}

/// Places on a lattice of whole numbers, where many distances are exactly 5.
std::vector<float> lattice_places(int count, Rng& rng) {
  return reference::floats_of(whole_numbers(count, 2, 12, rng));
}

TEST_F(MatchingKernels, NearestIsTheLowestOfEqualDistancesAndTheSecondIsFartherThanTheRadius) {
  int seconds = 0, tied = 0;
  for (const Counts& counts : kCounts) {
    const Rows queries = Rows::Zero(counts.queries, 1), trains = Rows::Zero(counts.trains, 1);
    for (const auto& [elsewhere_px, levels] :
         {std::pair{0.0, 5U}, {5.0, 5U}, {0.0, 10000U}, {5.0, 10000U}, {100.0, 5U}}) {
      // Some are below zero, as after rounding.
      const int first = counts.queries / 3;
      const Plane squares =
          whole_numbers(counts.queries - first, counts.trains, levels, rng_).array() - 1.0;
      const std::vector<float> places = lattice_places(counts.trains, rng_);
      const std::vector<Pair> found =
          nearest(squares, places, elsewhere_px, queries, trains, first);
      for (int i = 0; i < squares.rows(); ++i) {
        const auto [best, second] = reference::nearest(squares.row(i), places, elsewhere_px);
        const Pair& pair = found[to_index(i)];
        ASSERT_EQ(pair.best, best) << counts.queries << " x " << counts.trains << " query " << i;
        ASSERT_EQ(pair.second, second) << elsewhere_px << " px, query " << i;
        if (second < 0) continue;
        ++seconds;
        tied += squares(i, second) == squares(i, best) ? 1 : 0;
      }
    }
  }
  std::printf("%d seconds, %d of them tied with the best\n", seconds, tied);
  EXPECT_GT(tied, seconds / 4);
  EXPECT_GT(seconds - tied, seconds / 4);
}

TEST_F(MatchingKernels, NearestGivesTheSquaredDistancesOfTheDescriptorsThemselves) {
  double largest = 0.0;
  for (int length = 1; length <= 129; ++length) {
    // The distances from which it chooses have nothing to do with the descriptors.
    const int count = 2 + length % 5, first = length % 2;
    const Rows queries = reference::rounded(whole_numbers(count, length, 256, rng_) / 255.0);
    const Rows trains = reference::rounded(whole_numbers(count, length, 256, rng_) / 255.0);
    const Plane expected = reference::squared_distances(queries, trains);
    const std::vector<Pair> found =
        nearest(whole_numbers(count - first, count, 256, rng_), lattice_places(count, rng_), 0.0,
                queries, trains, first);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const auto off = [&](float square, int train) {
        const double right = expected(first + static_cast<int>(i), train);
        return difference(square, right, kRoundoff * (length + 3) * right);
      };
      largest = std::max({largest, off(found[i].best_square, found[i].best),
                          off(found[i].second_square, found[i].second)});
    }
  }
  std::printf("of (length + 3) 2^-24, squared distances differ by %.3f\n", largest);
  EXPECT_LT(largest, 1.0);
  const Rows one = Rows::Constant(1, 8, 3.0);
  EXPECT_EQ(nearest(Plane::Ones(1, 1), {0.0F, 0.0F}, 0.0, one, one, 0).front().second_square, 0.0F)
      << "there is no second";
}

TEST_F(MatchingKernels, NearestQueriesAreTheLowestOfEqualDistancesInBlocksOfAnySize) {
  for (const Counts& counts : kCounts) {
    const Plane squares = whole_numbers(counts.queries, counts.trains, 4, rng_).array() - 1.0;
    std::vector<int> expected;
    for (int j = 0; j < counts.trains; ++j) {
      expected.push_back(reference::smallest(squares.col(j)));
    }
    for (const int block : {1, 7, 32, 1000}) {
      if (block == 1 && counts.queries > 100) continue;
      EXPECT_EQ(nearest_queries(squares, block), expected)
          << counts.queries << " x " << counts.trains << " by " << block;
    }
  }
}

TEST_F(MatchingKernels, TogetherFindTheLowestOfTiedDescriptorsInBothDirections) {
  constexpr int kLength = 8;
  for (std::size_t n = 0; n < 2 * std::size(kCounts); ++n) {
    const Counts& counts = kCounts[n / 2];
    const std::uint32_t levels = n % 2 == 0 ? 2 : 1;  // some are equal, or all, to zeros
    const Rows queries = whole_numbers(counts.queries, kLength, levels, rng_);
    const Rows trains = whole_numbers(counts.trains, kLength, levels, rng_);
    const Plane expected = reference::squared_distances(queries, trains);
    const std::vector<float> places = lattice_places(counts.trains, rng_);
    const std::vector<float> found =
        distances(load(queries, false), 0, load(trains, false), kLength);
    const Plane squares = reference::plane_of(found.data(), counts.trains, counts.queries);
    const std::vector<Pair> pairs = nearest(squares, places, 5.0, queries, trains, 0);
    for (int i = 0; i < counts.queries; ++i) {
      const auto [best, second] = reference::nearest(expected.row(i), places, 5.0);
      const Pair& pair = pairs[to_index(i)];
      ASSERT_EQ(pair.best, best) << i;
      ASSERT_EQ(pair.second, second) << i;
      EXPECT_EQ(pair.best_square, static_cast<float>(expected(i, best)));
    }
    const std::vector<int> queries_found = nearest_queries(squares, 32);
    for (int j = 0; j < counts.trains; ++j) {
      EXPECT_EQ(queries_found[to_index(j)], reference::smallest(expected.col(j)));
    }
  }
}

}  // namespace
}  // namespace weft::sift_gpu
