// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <stdexcept>
#include <string>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/sdk/filter.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/random_sheet.hpp>

namespace weft::testing {

inline const Template kTemplate = make_template();

/// Matches at template points with separate image points; those off the mesh get no face.
inline Correspondences make_matches(const Points2& template_px, const Points2& image_px) {
  const Eigen::Index n = template_px.rows();
  const auto locator =
      FaceLocator::create(kTemplate.flat_px.matrix<2>(), kTemplate.faces.matrix<3>());
  Correspondences matches;
  matches.template_px = make_array<double>(template_px);
  matches.image_px = make_array<double>(image_px);
  matches.face = Array<std::int32_t>({n}, 0);
  matches.barycentrics = Array<double>({n, 3}, 0.0);
  matches.kept = Array<std::uint8_t>({n}, 0);
  matches.score = Array<double>({n}, 0.0);
  for (Eigen::Index i = 0; i < n; ++i) {
    const FaceLocation location = locator->locate(template_px.row(i).transpose());
    matches.face(i) = location.face;
    matches.barycentrics.matrix<3>().row(i) = location.weights;
    matches.kept(i) = 1;
    matches.score(i) = 1.0;
  }
  return matches;
}

inline Correspondences take(const Correspondences& all, const std::vector<Eigen::Index>& rows) {
  return make_matches(all.template_px.matrix<2>()(rows, Eigen::all),
                      all.image_px.matrix<2>()(rows, Eigen::all));
}

inline Points2 uniform_points(int count, Rng& rng) {
  Points2 points(count, 2);
  for (int i = 0; i < count; ++i) {
    points.row(i) << rng.uniform(0.0, 959.0), rng.uniform(0.0, 574.0);
  }
  return points;
}

inline Points2 similar(const Points2& points) {
  Eigen::Matrix2d turn;
  turn << 0.5, 0.2, -0.2, 0.5;
  return (points * turn).rowwise() + Eigen::RowVector2d(150.0, 40.0);
}

/// Matches of a bent surface, with a share of outliers.
inline LabelledMatches bent_matches(int count, double correct_rate, std::uint64_t seed) {
  Rng rng(seed);
  const auto shape = draw_deformation({}, make_camera(), rng);
  return draw_matches(kTemplate, make_camera(), shape->vertices_m, {count, correct_rate, 0.5, 2.0},
                      rng);
}

inline PluginAnswer run_on(PluginUnderTest& filter, const Correspondences& matches) {
  return filter.process(0, {input("correspondences", matches), input("template", kTemplate)});
}

/// Keeps its plugins, and so their answers, until the end of the test.
class MyNeighborTest : public ::testing::Test {
 protected:
  PluginAnswer run(const Correspondences& matches, const std::string& params = "{}") {
    return run_on(plugins_.emplace_back("filters/myneighbor", params), matches);
  }

 private:
  std::deque<PluginUnderTest> plugins_;
};

inline std::vector<int> flags(const InlierMask& mask) {
  return {mask.kept.data(), mask.kept.data() + mask.kept.rows()};
}

inline const Array<double>& evidence(const InlierMask& mask, const std::string& name) {
  const Array<double>* found = mask.diag.find(name);
  if (found == nullptr) throw std::out_of_range(name);
  return *found;
}

}  // namespace weft::testing
