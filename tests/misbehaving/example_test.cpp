// SPDX-License-Identifier: Apache-2.0
// The filter of docs/examples/your_own_filter, which stands for all plugins from outside the tree.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <weft/core/rng.hpp>

#include "misbehaving.hpp"

namespace weft::misbehaving {
namespace {

class LocalMotionTest : public ::testing::Test {
 protected:
  /// Matches on a grid that all move by the same stretch and shift.
  LocalMotionTest() {
    for (std::int64_t i = 0; i < matches_.count(); ++i) {
      const double u = 20.0 * static_cast<double>(i % 10), v = 20.0 * static_cast<double>(i / 10);
      matches_.template_px(i, 0) = u;
      matches_.template_px(i, 1) = v;
      matches_.image_px(i, 0) = 1.05 * u + 100.0;
      matches_.image_px(i, 1) = 0.95 * v + 50.0;
    }
  }

  const host::Outcome& call(const std::string& params = "{}") {
    resolved_ = resolve(registry_, "filters/local_motion", params);
    if (!resolved_.spec) throw std::runtime_error(resolved_.problem());
    const auto instance = context_.instantiate(*resolved_.spec, "filters");
    if (!instance) throw std::runtime_error(instance.error().message);
    const RecordView<Correspondences> view("correspondences", matches_);
    const weft_record inputs[] = {view.raw()};
    outcome_ = context_.call(**instance, 0, inputs, 0);
    return outcome_;
  }

  InlierMask filter(const std::string& params = "{}") {
    EXPECT_EQ(call(params).status, WEFT_OK) << outcome_.error.message;
    return *host::view_as<InlierMask>(*outcome_.find("inlier_mask"));
  }

  Correspondences matches_ = make_matches(100);
  const host::Registry registry_ = scan(WEFT_EXAMPLE_FOLDER);
  host::ExecutionContext context_{1, {}};
  Resolved resolved_;
  host::Outcome outcome_;
};

TEST_F(LocalMotionTest, KeepsMatchesThatMoveTogether) {
  const InlierMask mask = filter();
  for (std::int64_t i = 0; i < 100; ++i) {
    EXPECT_EQ(mask.kept(i), 1);
    EXPECT_GT(mask.score(i), 0.2);
  }
}

TEST_F(LocalMotionTest, RejectsMatchesThatJumpAway) {
  std::cout << "seed 11\n";
  Rng rng(11);
  const std::vector<int> wrong = rng.sample(100, 20);
  std::vector<std::uint8_t> expected(100, 1);
  for (const int i : wrong) {
    matches_.image_px(i, 0) += rng.below(2) == 0 ? 60.0 : -60.0;
    expected[static_cast<std::size_t>(i)] = 0;
  }
  const InlierMask mask = filter();
  for (std::int64_t i = 0; i < 100; ++i) {
    EXPECT_EQ(mask.kept(i), expected[static_cast<std::size_t>(i)]) << i;
  }
}

TEST_F(LocalMotionTest, KeepsAMatchWithoutNeighbours) {
  matches_.template_px(0, 0) = -5000.0;
  EXPECT_EQ(filter().kept(0), 1);
}

TEST_F(LocalMotionTest, GivesNoVoteToMatchesThatAnEarlierFilterRejectedAndKeepsNone) {
  for (std::int64_t i = 0; i < 100; ++i) {
    if (i == 55) continue;
    matches_.image_px(i, 0) += 60.0;
    matches_.kept(i) = 0;
  }
  const InlierMask mask = filter();
  for (std::int64_t i = 0; i < 100; ++i) {
    EXPECT_EQ(mask.kept(i), i == 55 ? 1 : 0) << i;
    EXPECT_TRUE(std::isfinite(mask.score(i))) << i;
  }
}

TEST_F(LocalMotionTest, IsAsStrictAsConfigured) {
  matches_.image_px(55, 1) += 8.0;
  EXPECT_EQ(filter("{max_deviation_px: 10}").kept(55), 1);
  EXPECT_EQ(filter("{max_deviation_px: 5}").kept(55), 0);
}

TEST_F(LocalMotionTest, GivesNoResultWhereNoMatchIsLeft) {
  std::fill_n(matches_.kept.data(), 100, std::uint8_t{0});
  EXPECT_EQ(call().status, WEFT_NO_RESULT);
  matches_ = make_matches(0);
  EXPECT_EQ(call().status, WEFT_NO_RESULT);
}

}  // namespace
}  // namespace weft::misbehaving
