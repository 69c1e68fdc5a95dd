// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <set>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/tests/keypoints_of.hpp"

namespace weft::guided {
namespace {

using matchers::keypoints_on_grid;
using matchers::random_descriptors;
using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;
using testing::PoseSpec;
using testing::SheetSpec;

constexpr int kOnSheet = 500, kBackground = 1500;

/// A texture with known descriptors and places on the surface.
struct Print {
  SheetSpec sheet;
  Template templ = testing::make_template(sheet);
  Camera camera = testing::make_camera();
  Keypoints keypoints;

  explicit Print(std::uint64_t seed) {
    std::printf("seed %d\n", static_cast<int>(seed));
    Rng rng(seed);
    keypoints = matchers::l2_keypoints(random_descriptors(kOnSheet, 128, rng));
    const Correspondences drawn = points_at(vertices_at({}));
    keypoints.xy_px = drawn.template_px;
    keypoints.face = drawn.face;
    keypoints.barycentrics = drawn.barycentrics;
  }

  Points3 vertices_at(const PoseSpec& pose) const {
    return testing::bent_vertices(templ, testing::make_cylinder(sheet, 0.25, 0.3, pose));
  }

  /// The keypoints' places on a shape: the same points of the surface for each.
  Correspondences points_at(const Points3& vertices_m) const {
    Rng same(77);
    return testing::draw_matches(templ, camera, vertices_m, {.count = kOnSheet}, same).matches;
  }
};

/// The image of the camera: descriptors with noise, each keypoint of a texture with its index.
struct Picture {
  explicit Picture(std::uint64_t seed) : rng(seed) {}

  /// A texture with the visible keypoints that `shows(i)` selects.
  template <class Shows>
  void add(const Print& print, const PoseSpec& pose, Shows&& shows) {
    const Correspondences at = print.points_at(print.vertices_at(pose));
    for (int i = 0; i < kOnSheet; ++i) {
      if (!shows(i)) continue;
      places.emplace_back(at.image_px(i, 0), at.image_px(i, 1));
      std::vector<float>& descriptor = descriptors.emplace_back();
      for (int k = 0; k < 128; ++k) {
        const double value = static_cast<double>(print.keypoints.descriptors(i, k));
        descriptor.push_back(
            static_cast<float>(std::max(0.0, std::floor(value + rng.uniform(-25.0, 25.0)))));
      }
    }
  }
  void add(const Print& print, const PoseSpec& pose) {
    add(print, pose, [](int) { return true; });
  }

  Keypoints keypoints() {
    const Array<float> background = random_descriptors(kBackground, 128, rng);
    for (int i = 0; i < kBackground; ++i) {
      places.emplace_back(rng.uniform(0, 639), rng.uniform(0, 479));
      descriptors.emplace_back(background.row(i), background.row(i) + 128);
    }
    Keypoints seen = matchers::l2_rows(descriptors);
    for (std::size_t j = 0; j < places.size(); ++j) {
      for (int k = 0; k < 2; ++k) seen.xy_px(static_cast<std::int64_t>(j), k) = places[j][k];
    }
    return seen;
  }

  Rng rng;
  std::vector<Eigen::Vector2d> places;
  std::vector<std::vector<float>> descriptors;
};

/// A previous frame that saw the surface in this pose and kept this many matches.
struct Past {
  Shape shape;
  Correspondences matches;

  Past(const Print& print, const PoseSpec& pose, int kept = kOnSheet) {
    const Points3 vertices_m = print.vertices_at(pose);
    shape.vertices_m = make_array<double>(vertices_m);
    shape.source = Array<std::uint8_t>({vertices_m.rows()}, 0);
    shape.confidence = 0.9;
    matches = print.points_at(vertices_m);
    for (std::int64_t n = kept; n < matches.count(); ++n) matches.kept(n) = 0;
  }
};

PluginAnswer run(PluginUnderTest& plugin, const Print& print, const Keypoints& seen,
                 const std::optional<Past>& past) {
  std::vector<testing::Input> inputs{input("keypoints", seen),
                                     input("template_keypoints", print.keypoints),
                                     input("template", print.templ), input("camera", print.camera)};
  if (past) {
    inputs.push_back(input("previous.shape", past->shape));
    inputs.push_back(input("previous.correspondences", past->matches));
  }
  return plugin.process(0, inputs);
}

using Pairs = std::set<std::pair<int, int>>;

Pairs pairs_of(const PluginAnswer& out) {
  EXPECT_EQ(out.status, WEFT_OK) << out.message;
  const Correspondences matches = out.get<Correspondences>().value();
  Pairs pairs;
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    pairs.insert({matches.template_keypoint(n), matches.image_keypoint(n)});
  }
  return pairs;
}

double evidence(const PluginAnswer& out, const char* name) {
  return out.get<Correspondences>()->diag.value(name, -1.0);
}

/// Inliers among pairs: the image keypoint `first + i` belongs to template keypoint i.
int correct(const Pairs& pairs, int first = 0) {
  int count = 0;
  for (const auto& [templ, image] : pairs) count += image == first + templ ? 1 : 0;
  return count;
}

Pairs by_whole_search(const Print& print, const Keypoints& seen, const std::string& params) {
  PluginUnderTest whole("matchers/descriptor", params);
  return pairs_of(
      whole.process(0, {input("keypoints", seen), input("template_keypoints", print.keypoints)}));
}

TEST(GuidedMatcher, FollowsASheetThatMovesALittle) {
  const Print print(1);
  Picture picture(2);
  picture.add(print, {.x_m = 0.01, .roll_rad = 0.03});
  const Keypoints seen = picture.keypoints();
  for (const char* direction : {"template_to_image", "image_to_template"}) {
    for (const char* mutual : {"false", "true"}) {
      const std::string params =
          std::string("{direction: ") + direction + ", mutual: " + mutual + "}";
      PluginUnderTest plugin("matchers/guided", params);
      const PluginAnswer out = run(plugin, print, seen, Past(print, {}));
      const Pairs found = pairs_of(out);
      EXPECT_EQ(evidence(out, "fallback"), 0.0);
      EXPECT_EQ(evidence(out, "guided"), static_cast<double>(found.size()));
      EXPECT_GT(evidence(out, "agreeing"), 0.95 * kOnSheet);
      EXPECT_GT(correct(found), 0.97 * kOnSheet);
      EXPECT_LT(static_cast<int>(found.size()) - correct(found), 0.02 * kOnSheet);
      // A match of the whole image is also a match of the right place.
      for (const auto& pair : by_whole_search(print, seen, params)) {
        if (pair.first == pair.second) {
          EXPECT_TRUE(found.count(pair)) << pair.first;
        }
      }
    }
  }
}

TEST(GuidedMatcher, SearchesTheWholeImageWhereNothingSaysWhereToLook) {
  const Print print(3);
  Picture picture(4);
  picture.add(print, {});
  const Keypoints seen = picture.keypoints();
  const Pairs whole = by_whole_search(print, seen, "{}");
  PluginUnderTest plugin("matchers/guided");
  const PluginAnswer first = run(plugin, print, seen, {});
  EXPECT_EQ(pairs_of(first), whole);
  EXPECT_EQ(evidence(first, "fallback"), 1.0);
  for (const ShapeState state : {ShapeState::weak, ShapeState::predicted, ShapeState::lost}) {
    Past past(print, {});
    past.shape.state = static_cast<std::int32_t>(state);
    const PluginAnswer out = run(plugin, print, seen, past);
    EXPECT_EQ(pairs_of(out), whole);
    EXPECT_EQ(evidence(out, "fallback"), 2.0);
  }
  Past doubtful(print, {});
  doubtful.shape.confidence = 0.3;
  const PluginAnswer out = run(plugin, print, seen, doubtful);
  EXPECT_EQ(pairs_of(out), whole);
  EXPECT_EQ(evidence(out, "fallback"), 3.0);
  EXPECT_EQ(evidence(out, "guided"), 0.0);
}

TEST(GuidedMatcher, FindsASheetThatJumpsInTheSameFrame) {
  const Print print(5);
  for (const PoseSpec& jump :
       {PoseSpec{.x_m = 0.12}, PoseSpec{.distance_m = 0.9}, PoseSpec{.roll_rad = 1.5}}) {
    Picture picture(6);
    picture.add(print, jump);
    const Keypoints seen = picture.keypoints();
    PluginUnderTest plugin("matchers/guided");
    const PluginAnswer out = run(plugin, print, seen, Past(print, {}));
    const Pairs found = pairs_of(out);
    EXPECT_EQ(evidence(out, "fallback"), 4.0);
    EXPECT_EQ(found, by_whole_search(print, seen, "{}"));
    EXPECT_GT(correct(found), 0.9 * kOnSheet);
  }
}

TEST(GuidedMatcher, DoesNotTakeMatchesToAnythingForASheetThatWasHardlySeen) {
  const Print print(7);
  Picture picture(8);
  picture.add(print, {.y_m = 0.08});
  const Keypoints seen = picture.keypoints();
  // Weak ratios let many outliers pass: more than the previous frame kept.
  PluginUnderTest plugin("matchers/guided", "{ratio: 0.95, matcher: {use: matchers/descriptor}}");
  const PluginAnswer out = run(plugin, print, seen, Past(print, {}, 40));
  EXPECT_EQ(evidence(out, "fallback"), 4.0) << evidence(out, "agreeing");
  EXPECT_GT(correct(pairs_of(out)), 0.9 * kOnSheet);
}

TEST(GuidedMatcher, FollowsAMotionWithinTheRadiusAndFindsOneBeyond) {
  const Print print(9);
  // 0.65 m away, 820 px: 1 mm is 1.26 px.
  for (const auto& [moved_m, fallback] : {std::pair(0.02, 0.0), std::pair(0.045, 4.0)}) {
    Picture picture(10);
    picture.add(print, {.x_m = moved_m});
    PluginUnderTest plugin("matchers/guided", "{radius_px: 30}");
    const PluginAnswer out = run(plugin, print, picture.keypoints(), Past(print, {}));
    EXPECT_EQ(evidence(out, "fallback"), fallback) << moved_m;
    EXPECT_GT(correct(pairs_of(out)), 0.9 * kOnSheet);
  }
}

TEST(GuidedMatcher, LeavesAPosterThatLooksAlikeForTheSheet) {
  const Print print(11);
  Picture picture(12);
  // At the previous place of the surface is a poster with a third of its texture; the surface
  // itself has moved on.
  picture.add(print, {.distance_m = 1.2, .x_m = 0.22});
  picture.add(print, {.distance_m = 1.2, .x_m = -0.2}, [](int i) { return i % 3 == 0; });
  const Keypoints seen = picture.keypoints();
  const std::string back =
      "{direction: image_to_template, matcher: {use: matchers/descriptor, params: {direction: "
      "image_to_template}}}";
  PluginUnderTest plugin("matchers/guided", back);
  const PluginAnswer out = run(plugin, print, seen, Past(print, {.distance_m = 1.2, .x_m = -0.2}));
  EXPECT_EQ(evidence(out, "fallback"), 4.0);
  EXPECT_GT(correct(pairs_of(out)), 0.9 * kOnSheet);
}

TEST(GuidedMatcher, FollowsTheCopyThatIsNearThePreviousShape) {
  const Print print(13);
  Picture picture(14);
  const PoseSpec left{.distance_m = 1.2, .x_m = -0.2}, right{.distance_m = 1.2, .x_m = 0.22};
  picture.add(print, left);
  picture.add(print, right);
  const Keypoints seen = picture.keypoints();
  PluginUnderTest plugin("matchers/guided");
  EXPECT_GT(correct(pairs_of(run(plugin, print, seen, Past(print, left)))), 0.9 * kOnSheet);
  EXPECT_GT(correct(pairs_of(run(plugin, print, seen, Past(print, right))), kOnSheet),
            0.9 * kOnSheet);
}

TEST(GuidedMatcher, FollowsASheetOfWhichAThirdIsCovered) {
  const Print print(15);
  Picture picture(16);
  picture.add(print, {.y_m = 0.005}, [](int i) { return i % 3 != 0; });
  PluginUnderTest plugin("matchers/guided");
  const PluginAnswer out = run(plugin, print, picture.keypoints(), Past(print, {}));
  EXPECT_EQ(evidence(out, "fallback"), 0.0);
  EXPECT_GT(evidence(out, "agreeing"), 0.6 * kOnSheet);
}

TEST(GuidedMatcher, AnswersTheSameAfterOtherFrames) {
  const Print print(17);
  Picture picture(18), other(19);
  picture.add(print, {.x_m = 0.01});
  other.add(print, {.x_m = 0.1});
  const Keypoints seen = picture.keypoints(), before = other.keypoints();
  PluginUnderTest fresh("matchers/guided"), warm("matchers/guided");
  run(warm, print, before, Past(print, {}));
  run(warm, print, before, {});
  const PluginAnswer a = run(fresh, print, seen, Past(print, {}));
  const PluginAnswer b = run(warm, print, seen, Past(print, {}));
  EXPECT_EQ(pairs_of(a), pairs_of(b));
  const Correspondences x = a.get<Correspondences>().value(), y = b.get<Correspondences>().value();
  for (std::int64_t n = 0; n < x.count(); ++n) EXPECT_EQ(x.ratio(n), y.ratio(n));
}

TEST(GuidedMatcher, TooFewKeypointsGiveNoResultWithTheReason) {
  const Print print(20);
  PluginUnderTest plugin("matchers/guided");
  for (const int count : {0, 1}) {
    Keypoints seen = matchers::l2_keypoints(Array<float>({count, 128}, 0.0F));
    const PluginAnswer out = run(plugin, print, seen, Past(print, {}));
    EXPECT_EQ(out.status, WEFT_NO_RESULT);
    EXPECT_THAT(out.message, ::testing::HasSubstr("needs at least 2"));
  }
}

}  // namespace
}  // namespace weft::guided
