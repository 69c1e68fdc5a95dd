// SPDX-License-Identifier: Apache-2.0
#include "chart_parts.hpp"

#include <set>

#include "chart_scene.hpp"

namespace weft::charts {
namespace {

/// The inputs of a filter for a scene.
FilterInput input_of(const ChartScene& scene, const Correspondences& matches,
                     const weft_call& call) {
  FilterInput in{Call(call)};
  in.correspondences = matches;
  in.templ = scene.templ;
  in.camera = scene.camera;
  return in;
}

TEST(ChartParts, AreTheConnectedPartsOfTheMesh) {
  const ChartScene scene;
  ChartParts parts;
  parts.update(scene.templ);
  ASSERT_EQ(parts.count(), 3);
  for (std::int32_t f = 0; f < scene.faces.rows(); ++f) {
    EXPECT_TRUE(ChartScene::is_of_chart(f, parts.of_face(f)));
  }
  EXPECT_EQ(parts.of_face(-1), -1);
  EXPECT_EQ(parts.of_face(static_cast<std::int32_t>(scene.faces.rows())), -1);
}

TEST(ChartParts, HaveTheSamePlacesInTheirWindowOfTheTexture) {
  ChartScene scene;
  for (std::int64_t y = 0; y < 400; ++y) {
    for (std::int64_t x = 0; x < 960; ++x) {
      scene.templ.texture(y, x) = static_cast<std::uint8_t>((7 * x + 13 * y) % 251);
    }
  }
  const SceneMatches made = matches_of(scene, {5, 6, 7}, 0.0, 1);
  const weft_call call{};
  ChartParts parts;
  parts.update(scene.templ);
  const FilterInput part =
      parts.part(input_of(scene, made.matches, call), 2, {11, 12, 13, 14, 15, 16, 17});
  const Template& templ = *part.templ;
  EXPECT_EQ(templ.vertices_m.rows(), ChartScene::kSide * ChartScene::kSide);
  EXPECT_EQ(templ.faces.rows(), ChartScene::kFacesPerChart);
  EXPECT_LE(templ.texture.dim(1), 202);
  EXPECT_EQ(templ.mask.dim(0), templ.texture.dim(0));
  ASSERT_EQ(part.correspondences.count(), 7);
  const Faces faces = templ.faces.matrix<3>();
  for (std::int64_t i = 0; i < 7; ++i) {
    const Correspondences& matches = part.correspondences;
    const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(i);
    const Eigen::Vector2d on_mesh =
        interpolate(templ.flat_px.matrix<2>(), faces, matches.face(i), weights);
    EXPECT_LT((on_mesh - matches.template_px.matrix<2>().row(i).transpose()).norm(), 1e-9);
    const Eigen::Vector3d place_m =
        interpolate(templ.vertices_m.matrix<3>(), faces, matches.face(i), weights);
    const Eigen::Vector3d expected_m = interpolate(scene.templ.vertices_m.matrix<3>(), scene.faces,
                                                   made.matches.face(11 + i), weights);
    EXPECT_LT((place_m - expected_m).norm(), 1e-15);
    EXPECT_EQ(matches.image_px(i, 0), made.matches.image_px(11 + i, 0));
    const auto at = [](double px) { return static_cast<std::int64_t>(std::floor(px)); };
    EXPECT_EQ(templ.texture(at(matches.template_px(i, 1)), at(matches.template_px(i, 0))),
              scene.templ.texture(at(made.matches.template_px(11 + i, 1)),
                                  at(made.matches.template_px(11 + i, 0))));
  }
}

TEST(ChartParts, HaveRevisionsOfTheirOwn) {
  ChartScene scene;
  const weft_call call{};
  std::set<std::uint64_t> revisions;
  ChartParts parts;
  for (const std::uint64_t revision : {1U, 2U}) {
    scene.templ.revision = revision;
    parts.update(scene.templ);
    const FilterInput in = input_of(scene, matches_of(scene, {1, 1, 1}, 0.0, 1).matches, call);
    for (int chart = 0; chart < 3; ++chart) {
      const std::uint64_t own = parts.part(in, chart, {chart}).templ->revision;
      EXPECT_EQ(own, parts.part(in, chart, {chart}).templ->revision);
      revisions.insert(own);
    }
  }
  EXPECT_EQ(revisions.size(), 6U);
  EXPECT_EQ(revisions.count(0) + revisions.count(1) + revisions.count(2), 0U);
  scene.templ.revision = 0;
  parts.update(scene.templ);
  const FilterInput in = input_of(scene, matches_of(scene, {1, 1, 1}, 0.0, 1).matches, call);
  EXPECT_EQ(parts.part(in, 1, {1}).templ->revision, 0U);
}

TEST(ChartParts, HaveTheirVerticesOfThePreviousShape) {
  const ChartScene scene;
  const weft_call call{};
  ChartParts parts;
  parts.update(scene.templ);
  FilterInput in = input_of(scene, matches_of(scene, {1, 1, 1}, 0.0, 1).matches, call);
  Shape shape;
  shape.vertices_m = make_array<double>(scene.vertices_m);
  shape.source = Array<std::uint8_t>({scene.vertices_m.rows()}, 1);
  shape.confidence = 0.7;
  in.previous_shape = shape;
  const FilterInput part = parts.part(in, 1, {1});
  ASSERT_EQ(part.previous_shape->vertices_m.rows(), 64);
  EXPECT_EQ(part.previous_shape->confidence, 0.7);
  for (std::int64_t v = 0; v < 64; ++v) {
    EXPECT_EQ(part.previous_shape->vertices_m(v, 1), scene.vertices_m(64 + v, 1));
  }
  in.previous_shape->vertices_m = Array<double>({5, 3}, 0.0);  // another mesh
  EXPECT_FALSE(parts.part(in, 1, {1}).previous_shape.has_value());
}

}  // namespace
}  // namespace weft::charts
