// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>
#include <weft/data/matrix.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

using namespace weft::testing;

TEST(MyPluginPass, PutsTheTruePointOfEachKeptMatchOnItsRay) {
  std::cout << "seed 4\n";
  weft::Rng rng(4);
  const SheetSpec sheet;
  const weft::Template templ = make_template(sheet);
  const weft::Camera camera = make_camera();
  const weft::Points3 vertices_m = bent_vertices(templ, make_cylinder(sheet, 0.3, 0.4));
  weft::Correspondences matches =
      draw_matches(templ, camera, vertices_m, {.count = 60}, rng).matches;
  matches.kept(7) = 0;

  PluginUnderTest pass("passes/my_plugin");
  const PluginAnswer answer = pass.process(
      0, {input("template", templ), input("camera", camera), input("correspondences", matches)});
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  const auto lines = *answer.get<weft::Sightlines>();
  ASSERT_EQ(lines.count(), 59);
  EXPECT_GT(lines.coverage, 0.1);
  EXPECT_LT(lines.coverage, 1.0);
  for (std::int64_t k = 0; k < lines.count(); ++k) {
    const Eigen::Vector3d place_m =
        weft::interpolate(vertices_m, templ.faces.matrix<3>(), lines.face(k),
                          lines.barycentrics.matrix<3>().row(k).transpose());
    const Eigen::Vector3d ray = lines.ray.matrix<3>().row(k).transpose();
    EXPECT_LT(weft::distance_to_ray_m(place_m, ray), 1e-9) << k;
  }
}

TEST(MyPluginPass, SaysHowManyMatchesAreTooFew) {
  std::cout << "seed 5\n";
  weft::Rng rng(5);
  const weft::Template templ = make_template();
  const weft::Points3 vertices_m = bent_vertices(templ, make_cylinder({}, 0.3, 0.4));
  const LabelledMatches drawn = draw_matches(templ, make_camera(), vertices_m, {.count = 5}, rng);
  PluginUnderTest pass("passes/my_plugin");
  const PluginAnswer answer =
      pass.process(0, {input("template", templ), input("camera", make_camera()),
                       input("correspondences", drawn.matches)});
  EXPECT_EQ(answer.status, WEFT_NO_RESULT);
  EXPECT_EQ(answer.message, "5 matches are kept on the mesh, of at least 8");
}

}  // namespace
