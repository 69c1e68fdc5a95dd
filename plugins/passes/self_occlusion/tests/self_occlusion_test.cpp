// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/visibility.hpp>
#include <weft/data/warp.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

using ::testing::HasSubstr;
using weft::SightReason;
using weft::Visibility;
using weft::testing::input;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr std::uint64_t kSeed = 20240918;

/// A surface of 10 x 6 vertices in front of the camera. Its two columns at the right can be folded
/// behind it, flat and 2 cm away, where they are invisible.
class SelfOcclusion : public ::testing::Test {
 protected:
  static constexpr int kColumns = 10;

  SelfOcclusion() {
    flat_m_ = templ_.vertices_m.matrix<3>();
    flat_m_.rowwise() += Eigen::RowVector3d(-0.15, -0.09, 0.6);
    folded_m_ = flat_m_;
    for (Eigen::Index v = 0; v < flat_m_.rows(); ++v) {
      const auto column = v % kColumns;
      if (column < 8) continue;
      folded_m_.row(v) = flat_m_.row(v - 2 * (column - 8) - 3) + Eigen::RowVector3d(0, 0, 0.02);
    }
    RecordProperty("seed", std::to_string(kSeed));
  }

  static weft::Shape shape(const weft::Points3& vertices_m) {
    weft::Shape shape;
    shape.vertices_m = weft::make_array<double>(vertices_m);
    shape.source = weft::Array<std::uint8_t>({vertices_m.rows()}, 0);
    return shape;
  }

  /// As a previous frame left it.
  static Visibility uniform(bool visible, double score) {
    Visibility all;
    all.visible = weft::Array<std::uint8_t>({60}, 0);
    all.score = weft::Array<double>({60}, 0.0);
    all.reason = weft::Array<std::uint8_t>({60}, 0);
    std::fill_n(all.visible.data(), 60, visible ? 1 : 0);
    std::fill_n(all.score.data(), 60, score);
    std::fill_n(all.reason.data(), 60, static_cast<std::uint8_t>(visible ? 0 : 3));
    return all;
  }

  weft::Correspondences matches(int count, const weft::Points3& vertices_m) const {
    weft::Rng rng(kSeed);
    weft::testing::MatchSpec spec;
    spec.count = count;
    return weft::testing::draw_matches(templ_, camera_, vertices_m, spec, rng).matches;
  }

  PluginAnswer run(std::vector<weft::testing::Input> inputs, const std::string& params = "{}") {
    inputs.push_back(input("template", templ_));
    inputs.push_back(input("camera", camera_));
    plugins_.push_back(std::make_unique<PluginUnderTest>("passes/self_occlusion", params));
    return plugins_.back()->process(0, inputs);
  }

  Visibility look(std::vector<weft::testing::Input> inputs, const std::string& params = "{}") {
    const PluginAnswer out = run(std::move(inputs), params);
    EXPECT_EQ(out.status, WEFT_OK) << out.message;
    return out.get<Visibility>().value();
  }

  static bool is_folded(std::int64_t vertex) { return vertex % kColumns >= 8; }

  weft::Template templ_ = weft::testing::make_template();
  weft::Camera camera_ = weft::testing::make_camera();
  weft::Points3 flat_m_, folded_m_;
  std::vector<std::unique_ptr<PluginUnderTest>> plugins_;
};

TEST_F(SelfOcclusion, TellsForEachVertexWhetherItIsSeenAndWhyNot) {
  const Visibility seen = look({input("shape", shape(flat_m_))});
  const Visibility folded = look({input("shape", shape(folded_m_))});
  for (std::int64_t v = 0; v < 60; ++v) {
    EXPECT_EQ(seen.visible(v), 1);
    EXPECT_EQ(folded.visible(v), is_folded(v) ? 0 : 1) << v;
    EXPECT_EQ(folded.why(v), is_folded(v) ? SightReason::hidden : SightReason::seen) << v;
  }
}

TEST_F(SelfOcclusion, HidesAVertexInTheSecondFrameOrAtOnceWhereNoMatchIsLeft) {
  // Matches on the part that is seen, few enough that no match is missed elsewhere.
  weft::Correspondences far = matches(200, flat_m_);
  for (std::int64_t i = 0; i < far.count(); ++i) {
    far.kept(i) = i < 20 && templ_.faces(far.face(i), 0) % kColumns < 4 ? 1 : 0;
  }
  const auto folded = input("shape", shape(folded_m_));
  const Visibility before = uniform(true, 1.0);
  const Visibility first = look({folded, input("previous.visibility", before)});
  EXPECT_EQ(first.visible(9), 1);
  EXPECT_NEAR(first.score(9), 0.4, 1e-12);
  const Visibility second = look({folded, input("previous.visibility", first)});
  EXPECT_EQ(second.visible(9), 1) << "below the threshold for the first time";
  EXPECT_NEAR(second.score(9), 0.16, 1e-12);
  const Visibility third = look({folded, input("previous.visibility", second)});
  EXPECT_EQ(third.visible(9), 0);
  const Visibility at_once =
      look({folded, input("previous.visibility", first), input("correspondences", far)});
  EXPECT_EQ(at_once.visible(9), 0) << "no match around it";
}

TEST_F(SelfOcclusion, ShowsAVertexAgainAboveTheUpperThreshold) {
  const auto flat = input("shape", shape(flat_m_));
  const Visibility first = look({flat, input("previous.visibility", uniform(false, 0.0))});
  EXPECT_EQ(first.visible(33), 0);
  EXPECT_EQ(first.why(33), SightReason::hidden) << "as it was";
  EXPECT_NEAR(first.score(33), 0.6, 1e-12);
  const Visibility second = look({flat, input("previous.visibility", first)});
  EXPECT_EQ(second.visible(33), 1);
  EXPECT_NEAR(second.score(33), 0.84, 1e-12);
  const Visibility forgetful =
      look({flat, input("previous.visibility", uniform(false, 0.0))}, "{memory: 0}");
  EXPECT_EQ(forgetful.visible(33), 1);
}

TEST_F(SelfOcclusion, MatchesOverruleTheShape) {
  // The image shows a flat surface, but the tested shape is folded.
  const Visibility visibility =
      look({input("shape", shape(folded_m_)), input("correspondences", matches(4000, flat_m_)),
            input("previous.visibility", uniform(false, 0.0))},
           "{match_tolerance_px: 30}");
  for (std::int64_t v = 0; v < 60; ++v) {
    EXPECT_EQ(visibility.visible(v), 1) << v;
    EXPECT_EQ(visibility.score(v), 1.0) << v;
  }
  EXPECT_EQ(visibility.diag.value("overruled_by_matches", 0.0), 12.0);
}

TEST_F(SelfOcclusion, OneMatchOrTwoThatDisagreeDoNot) {
  weft::Correspondences few = matches(800, flat_m_);
  for (std::int64_t i = 0; i < few.count(); ++i) {
    few.kept(i) = is_folded(templ_.faces(few.face(i), 0)) &&
                  is_folded(templ_.faces(few.face(i), 1)) &&
                  is_folded(templ_.faces(few.face(i), 2));
    few.image_px(i, 0) += 1000.0 * static_cast<double>(i);
  }
  const Visibility visibility = look(
      {input("shape", shape(folded_m_)), input("correspondences", few)}, "{missing_matches: 0}");
  for (std::int64_t v = 0; v < 60; ++v) EXPECT_EQ(visibility.visible(v), is_folded(v) ? 0 : 1) << v;
}

TEST_F(SelfOcclusion, DoubtsAVertexWhereMatchesAreMissing) {
  weft::Correspondences left = matches(800, flat_m_);
  for (std::int64_t i = 0; i < left.count(); ++i) {
    for (int k = 0; k < 3; ++k) {
      if (templ_.faces(left.face(i), k) % kColumns > 7) left.kept(i) = 0;
    }
  }
  const auto flat = input("shape", shape(flat_m_));
  const Visibility doubted = look({flat, input("correspondences", left)});
  const Visibility trusting = look({flat, input("correspondences", left)}, "{missing_matches: 0}");
  for (std::int64_t v = 0; v < 60; ++v) {
    EXPECT_EQ(doubted.visible(v), is_folded(v) ? 0 : 1) << v;
    EXPECT_EQ(doubted.why(v) == SightReason::unconfirmed, is_folded(v)) << v;
    EXPECT_EQ(trusting.visible(v), 1) << v;
  }
  EXPECT_EQ(doubted.diag.value("unconfirmed", 0.0), 12.0);
}

TEST_F(SelfOcclusion, LooksAtAFreshPreviousShapeThenAtTheWarpThenAtNothing) {
  weft::Shape before = shape(folded_m_);
  weft::WarpSamples samples;
  // The image is turned over where the surface is folded.
  weft::Points2 warped_px = weft::project_points(weft::testing::pinhole(camera_), flat_m_);
  for (Eigen::Index v = 0; v < 60; ++v) {
    if (is_folded(v)) warped_px(v, 0) = 2.0 * warped_px(7, 0) - warped_px(v, 0);
  }
  samples.xy_px = weft::make_array<double>(warped_px);
  samples.valid = weft::Array<std::uint8_t>({60}, 0);
  std::fill_n(samples.valid.data(), 60, 1);
  const auto warp = input("warp_samples", samples);
  const Visibility by_shape = look({input("previous.shape", before), warp});
  EXPECT_EQ(by_shape.diag.value("looked_at", -1.0), 1.0);
  EXPECT_EQ(by_shape.why(9), SightReason::hidden);
  before.age_frames = 5;
  for (const auto& stale :
       {std::vector{input("previous.shape", before), warp}, std::vector{warp}}) {
    const Visibility by_warp = look(stale);
    EXPECT_EQ(by_warp.diag.value("looked_at", -1.0), 2.0);
    for (std::int64_t v = 0; v < 60; ++v) EXPECT_EQ(by_warp.visible(v), is_folded(v) ? 0 : 1) << v;
  }
  const PluginAnswer nothing = run({input("previous.shape", before)});
  EXPECT_EQ(nothing.status, WEFT_NO_RESULT);
  EXPECT_THAT(nothing.message, HasSubstr("neither a shape nor a warp"));
}

TEST_F(SelfOcclusion, KeepsWhatItKnewOfASheetThatIsSeenEdgeOn) {
  weft::Points3 edge_on_m = flat_m_;
  edge_on_m.col(2) = edge_on_m.col(0).array() + 0.6;
  edge_on_m.col(0).setZero();
  const auto sheet = input("shape", shape(edge_on_m));
  const Visibility shown = look({sheet, input("previous.visibility", uniform(true, 0.9))});
  const Visibility hidden = look({sheet, input("previous.visibility", uniform(false, 0.1))});
  EXPECT_EQ(shown.visible(30), 1);
  EXPECT_EQ(shown.score(30), 0.9);
  EXPECT_EQ(hidden.visible(30), 0);
  EXPECT_EQ(hidden.score(30), 0.1);
}

TEST_F(SelfOcclusion, RefusesWhatIsOfAnotherTemplate) {
  weft::Points3 fewer_m = flat_m_.topRows(59);
  const PluginAnswer shape_refused = run({input("shape", shape(fewer_m))});
  EXPECT_EQ(shape_refused.status, WEFT_ERROR);
  EXPECT_THAT(shape_refused.message, HasSubstr("59"));
  weft::Correspondences strange = matches(10, flat_m_);
  strange.face(3) = 90;
  const PluginAnswer face_refused =
      run({input("shape", shape(flat_m_)), input("correspondences", strange)});
  EXPECT_EQ(face_refused.status, WEFT_ERROR);
  EXPECT_THAT(face_refused.message, HasSubstr("match 3 lies in face 90"));
}

TEST_F(SelfOcclusion, DoesNotLookAtAShapeBehindTheCameraOrThatIsNotFinite) {
  weft::Points3 behind_m = flat_m_;
  behind_m(0, 2) = -0.1;
  EXPECT_EQ(run({input("shape", shape(behind_m))}).status, WEFT_NO_RESULT);
}

}  // namespace
