// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/data/visibility.hpp>
#include <weft/data/warp.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

using weft::Sightlines;
using weft::testing::input;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr std::uint64_t kSeed = 20240917;

/// A bent surface, seen exactly: the warp samples are the projected vertices.
struct Scene {
  weft::Template templ = weft::testing::make_template();
  weft::Camera camera = weft::testing::make_camera();
  weft::DevelopableSheet sheet = weft::testing::make_cylinder({}, 0.25, 0.4);
  weft::Points3 truth_m = weft::testing::bent_vertices(templ, sheet);
  weft::WarpSamples samples;
  weft::Correspondences matches;

  Scene() {
    const std::int64_t vertices = templ.vertices_m.rows();
    samples.xy_px =
        weft::make_array<double>(weft::project_points(weft::testing::pinhole(camera), truth_m));
    samples.valid = weft::Array<std::uint8_t>({vertices}, 0);
    std::fill_n(samples.valid.data(), vertices, std::uint8_t{1});
    draw(400);
  }

  void draw(int count) {
    weft::Rng rng(kSeed);
    ::testing::Test::RecordProperty("seed", std::to_string(kSeed));
    weft::testing::MatchSpec spec;
    spec.count = count;
    matches = weft::testing::draw_matches(templ, camera, truth_m, spec, rng).matches;
  }

  /// Exactly one match, in the middle of each of these faces.
  void one_match_in(const std::vector<std::int32_t>& faces) {
    draw(static_cast<int>(faces.size()));
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const auto row = static_cast<std::int64_t>(i);
      matches.face(row) = faces[i];
      matches.barycentrics.matrix<3>().row(row).setConstant(1.0 / 3.0);
    }
  }

  PluginAnswer run(const std::string& params = "{}", const weft::Visibility* visibility = nullptr) {
    plugins.push_back(std::make_unique<PluginUnderTest>("passes/salient_cells", params));
    std::vector<weft::testing::Input> inputs{input("template", templ), input("camera", camera),
                                             input("warp_samples", samples),
                                             input("correspondences", matches)};
    if (visibility != nullptr) inputs.push_back(input("visibility", *visibility));
    return plugins.back()->process(0, inputs);
  }

  std::vector<std::unique_ptr<PluginUnderTest>> plugins{};
};

std::vector<std::int32_t> ids(const Sightlines& lines) {
  return {lines.vertex.data(), lines.vertex.data() + lines.count()};
}

std::vector<std::int32_t> corners(const Scene& scene, const std::vector<std::int32_t>& faces) {
  std::set<std::int32_t> result;
  for (const std::int32_t f : faces) {
    for (int k = 0; k < 3; ++k) result.insert(scene.templ.faces(f, k));
  }
  return {result.begin(), result.end()};
}

TEST(SalientCells, OneMatchSelectsTheThreeVerticesOfItsFace) {
  Scene scene;
  scene.one_match_in({37});
  const PluginAnswer out = scene.run();
  ASSERT_EQ(out.status, WEFT_DEGENERATE) << out.message;
  const Sightlines lines = out.get<Sightlines>().value();
  EXPECT_EQ(ids(lines), corners(scene, {37}));
  EXPECT_EQ(lines.diag.value("low_confidence", 0.0), 1.0);
  EXPECT_NEAR(lines.coverage, 1.0 / 90.0, 1e-12);
}

TEST(SalientCells, AMatchOnASharedEdgeCountsForItsOwnFaceOnly) {
  Scene scene;
  scene.one_match_in({12});
  scene.matches.barycentrics(0, 0) = 0.0;
  scene.matches.barycentrics(0, 1) = scene.matches.barycentrics(0, 2) = 0.5;
  EXPECT_EQ(ids(scene.run().get<Sightlines>().value()), corners(scene, {12}));
}

TEST(SalientCells, AReachSelectsFacesByTheirDistanceToMatchesAndNotByTheirSize) {
  Scene scene;
  scene.one_match_in({37});
  const auto flat_px = scene.templ.flat_px.matrix<2>();
  const Eigen::RowVector2d match_px = scene.matches.template_px.matrix<2>().row(0);
  const double reach_px =
      0.2 * (flat_px.colwise().maxCoeff() - flat_px.colwise().minCoeff()).norm();
  std::vector<std::int32_t> near{37};
  for (std::int32_t f = 0; f < scene.templ.faces.rows(); ++f) {
    Eigen::RowVector2d middle_px = Eigen::RowVector2d::Zero();
    for (int k = 0; k < 3; ++k) middle_px += flat_px.row(scene.templ.faces(f, k)) / 3.0;
    if ((middle_px - match_px).norm() <= reach_px) near.push_back(f);
  }
  ASSERT_GT(near.size(), 8U);
  ASSERT_LT(near.size(), 45U);
  EXPECT_EQ(ids(scene.run("{reach: 0.2}").get<Sightlines>().value()), corners(scene, near));
  EXPECT_EQ(ids(scene.run("{reach: 0}").get<Sightlines>().value()), corners(scene, {37}));
  scene.matches.kept(0) = 0;
  EXPECT_EQ(scene.run("{reach: 0.2}").status, WEFT_NO_RESULT);
}

TEST(SalientCells, AReachAsLargeAsTheTemplateSelectsAll) {
  Scene scene;
  scene.one_match_in({37, 3});
  EXPECT_EQ(scene.run("{reach: 1}").get<Sightlines>().value().count(), 60);
}

TEST(SalientCells, MatchesEverywhereSelectAllVerticesAscending) {
  Scene scene;
  std::vector<std::int32_t> faces(weft::to_index(scene.templ.faces.rows()));
  std::iota(faces.begin(), faces.end(), 0);
  scene.one_match_in(faces);
  const PluginAnswer out = scene.run();
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const Sightlines lines = out.get<Sightlines>().value();
  std::vector<std::int32_t> all(60);
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(ids(lines), all);
  EXPECT_DOUBLE_EQ(lines.coverage, 1.0);
}

TEST(SalientCells, RaysAreUnitAndPassThroughTheTrueVertices) {
  Scene scene;
  const Sightlines lines = scene.run().get<Sightlines>().value();
  ASSERT_GT(lines.count(), 40);
  for (std::int64_t i = 0; i < lines.count(); ++i) {
    const Eigen::Vector3d ray = lines.ray.matrix<3>().row(i);
    EXPECT_NEAR(ray.norm(), 1.0, 1e-15);
    const Eigen::Vector3d truth = scene.truth_m.row(lines.vertex(i));
    EXPECT_LT(weft::distance_to_ray_m(truth, ray), 1e-9);
  }
}

TEST(SalientCells, ThePrincipalPointIsSeenStraightAhead) {
  Scene scene;
  scene.one_match_in({0});
  const std::int32_t vertex = scene.templ.faces(0, 1);
  scene.samples.xy_px(vertex, 0) = scene.camera.cx;
  scene.samples.xy_px(vertex, 1) = scene.camera.cy;
  const Sightlines lines = scene.run().get<Sightlines>().value();
  const auto found = ids(lines);
  const auto i = std::find(found.begin(), found.end(), vertex) - found.begin();
  EXPECT_EQ(Eigen::Vector3d(lines.ray.matrix<3>().row(i)), Eigen::Vector3d::UnitZ());
}

TEST(SalientCells, TheStoredFaceAndWeightsNameTheVertex) {
  Scene scene;
  const Sightlines lines = scene.run().get<Sightlines>().value();
  for (std::int64_t i = 0; i < lines.count(); ++i) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      sum += lines.barycentrics(i, k);
      if (lines.barycentrics(i, k) == 1.0) {
        EXPECT_EQ(scene.templ.faces(lines.face(i), k), lines.vertex(i));
      }
    }
    EXPECT_EQ(sum, 1.0);
  }
}

TEST(SalientCells, TheOrderOfMatchesDoesNotMatter) {
  Scene scene;
  scene.one_match_in({5, 60, 23, 71});
  const auto before = ids(scene.run().get<Sightlines>().value());
  scene.one_match_in({71, 23, 5, 60});
  EXPECT_EQ(ids(scene.run().get<Sightlines>().value()), before);
}

TEST(SalientCells, RejectedMatchesSelectNothing) {
  Scene scene;
  scene.one_match_in({5, 60});
  scene.matches.kept(1) = 0;
  EXPECT_EQ(ids(scene.run().get<Sightlines>().value()), corners(scene, {5}));
}

TEST(SalientCells, ACellNeedsItsMinimumOfMatches) {
  Scene scene;
  scene.one_match_in({5, 60, 60});
  EXPECT_EQ(ids(scene.run("{min_matches_per_cell: 2}").get<Sightlines>().value()),
            corners(scene, {60}));
}

TEST(SalientCells, PointsThatCannotBeUsedAreDroppedAndCounted) {
  Scene scene;
  weft::Visibility visibility;
  visibility.visible = weft::Array<std::uint8_t>({60}, 0);
  visibility.score = weft::Array<double>({60}, 0.0);
  visibility.reason = weft::Array<std::uint8_t>({60}, 0);
  std::fill_n(visibility.visible.data(), 60, std::uint8_t{1});
  visibility.visible(25) = 0;
  scene.samples.xy_px(12, 0) = std::nan("");
  scene.samples.valid(13) = 0;
  scene.samples.xy_px(14, 0) = 640.0 + 33.0;
  scene.samples.xy_px(15, 0) = 640.0 + 30.0;
  const Sightlines lines = scene.run("{}", &visibility).get<Sightlines>().value();
  EXPECT_THAT(ids(lines), ::testing::Not(::testing::Contains(::testing::AnyOf(12, 13, 14, 25))));
  EXPECT_THAT(ids(lines), ::testing::Contains(15));
  EXPECT_EQ(lines.diag.value("dropped_not_evaluated", 0.0), 2.0);
  EXPECT_EQ(lines.diag.value("dropped_outside", 0.0), 1.0);
  EXPECT_EQ(lines.diag.value("dropped_hidden", 0.0), 1.0);
}

TEST(SalientCells, FoldedAndSqueezedFacesAreRejectedOnRequest) {
  Scene scene;
  const auto all = ids(scene.run().get<Sightlines>().value());
  // The corner vertex of the mesh is pulled over its neighbours: its face turns over.
  const std::int32_t corner = 0;
  scene.samples.xy_px(corner, 0) += 120.0;
  scene.samples.xy_px(corner, 1) += 120.0;
  EXPECT_EQ(ids(scene.run().get<Sightlines>().value()), all);
  const Sightlines lines = scene.run("{reject_folded: true}").get<Sightlines>().value();
  EXPECT_THAT(ids(lines), ::testing::Not(::testing::Contains(corner)));
  EXPECT_GE(lines.diag.value("folded_faces", 0.0), 1.0);
  EXPECT_GE(lines.count(), static_cast<std::int64_t>(all.size()) - 2);
}

TEST(SalientCells, ASheetSeenFromBehindIsNotFolded) {
  Scene scene;
  for (std::int64_t v = 0; v < 60; ++v)
    scene.samples.xy_px(v, 0) = 639.0 - scene.samples.xy_px(v, 0);
  const Sightlines lines = scene.run("{reject_folded: true}").get<Sightlines>().value();
  EXPECT_EQ(lines.diag.value("folded_faces", -1.0), 0.0);
  EXPECT_EQ(ids(lines), ids(scene.run().get<Sightlines>().value()));
}

TEST(SalientCells, WeightsGrowWithTheMatchesAroundAVertex) {
  Scene scene;
  scene.one_match_in({5, 60, 60});
  const Sightlines lines = scene.run("{weight_by_matches: true}").get<Sightlines>().value();
  for (std::int64_t i = 0; i < lines.count(); ++i) {
    const double matches = lines.face(i) == 60 ? 2.0 : 1.0;
    EXPECT_DOUBLE_EQ(lines.weight(i), 1.0 - std::exp(-0.5 * matches));
  }
}

TEST(SalientCells, MatchesThemselvesCanBeTheSightlines) {
  Scene scene;
  scene.matches.kept(3) = 0;
  const PluginAnswer out = scene.run("{mode: matches}");
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const Sightlines lines = out.get<Sightlines>().value();
  ASSERT_EQ(lines.count(), 399);
  const weft::Faces faces = scene.templ.faces.matrix<3>();
  for (std::int64_t i = 0; i < lines.count(); ++i) {
    ASSERT_EQ(lines.vertex(i), -1);
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      point += lines.barycentrics(i, k) * scene.truth_m.row(faces(lines.face(i), k)).transpose();
    }
    EXPECT_LT(weft::distance_to_ray_m(point, lines.ray.matrix<3>().row(i)), 1e-9);
  }
}

TEST(SalientCells, TooFewSightlinesAreNoResult) {
  Scene scene;
  scene.one_match_in({4});
  const PluginAnswer few = scene.run("{min_sightlines: 4}");
  EXPECT_EQ(few.status, WEFT_NO_RESULT);
  EXPECT_EQ(few.message, "too few sightlines: 3 of at least 4");
  scene.samples.valid(scene.templ.faces(4, 0)) = 0;
  EXPECT_EQ(scene.run().message, "too few sightlines: 2 of at least 3");
  scene.matches.face(0) = -1;
  EXPECT_EQ(scene.run().status, WEFT_NO_RESULT);
}

TEST(SalientCells, NoMatchesAreNoResult) {
  Scene scene;
  scene.draw(0);
  EXPECT_EQ(scene.run().status, WEFT_NO_RESULT);
}

TEST(SalientCells, AFaceThatTheTemplateLacksIsAnError) {
  Scene scene;
  scene.one_match_in({4, 90});
  const PluginAnswer out = scene.run();
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, ::testing::HasSubstr("face 90"));
}

TEST(SalientCells, SamplesOfAnotherTemplateAreAnError) {
  Scene scene;
  scene.samples.xy_px = weft::Array<double>({59, 2}, 0.0);
  scene.samples.valid = weft::Array<std::uint8_t>({59}, 0);
  EXPECT_EQ(scene.run().status, WEFT_ERROR);
}

TEST(SalientCells, FewSightlinesOrLittleCoverageAreFlagged) {
  Scene scene;
  scene.one_match_in({0, 20, 40, 60, 80});  // 5 of 90 faces, but more than 8 vertices
  const PluginAnswer little = scene.run();
  EXPECT_EQ(little.status, WEFT_DEGENERATE);
  EXPECT_GE(little.get<Sightlines>()->count(), 8);
  EXPECT_EQ(little.message, std::to_string(little.get<Sightlines>()->count()) +
                                " sightlines cover 6 % of the template");
  scene.draw(400);
  std::fill_n(scene.samples.valid.data(), 53, std::uint8_t{0});
  const PluginAnswer few = scene.run();
  EXPECT_EQ(few.status, WEFT_DEGENERATE);
  EXPECT_EQ(few.get<Sightlines>()->count(), 7);
  EXPECT_GT(few.get<Sightlines>()->coverage, 0.9);
  EXPECT_EQ(few.get<Sightlines>()->diag.value("low_confidence", 0.0), 1.0);
}

}  // namespace
