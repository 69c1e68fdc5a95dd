// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/warp_model.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/tests/maps.hpp"

namespace weft::testing {

inline Correspondences matches_at(const Points2& points, const Map& map) {
  const Eigen::Index n = points.rows();
  Correspondences matches;
  matches.template_px = make_array<double>(points);
  matches.image_px = Array<double>({n, 2}, 0.0);
  matches.face = Array<std::int32_t>({n}, 0);
  matches.barycentrics = Array<double>({n, 3}, 0.0);
  matches.kept = Array<std::uint8_t>({n}, 0);
  matches.score = Array<double>({n}, 0.0);
  for (Eigen::Index i = 0; i < n; ++i) {
    matches.image_px.matrix<2>().row(i) = map(points(i, 0), points(i, 1));
    matches.kept(i) = 1;
    matches.score(i) = 1.0;
  }
  return matches;
}

inline Points2 uniform_points(int count, Rng& rng) {
  Points2 points(count, 2);
  for (int i = 0; i < count; ++i) {
    points.row(i) << rng.uniform(-0.5, 959.5), rng.uniform(-0.5, 574.5);
  }
  return points;
}

inline const testing::SheetSpec kSheet{};

/// The plugin with a template of 960 x 575 px.
struct WarpBench {
  WarpBench(const std::string& id, const std::string& params) : plugin(id, params) {}

  PluginAnswer fit(const Correspondences& matches) {
    return plugin.process(0, {input("correspondences", matches), input("template", templ)});
  }
  PluginAnswer fit(const Correspondences& matches, const Weights& weights) {
    return plugin.process(0, {input("correspondences", matches), input("template", templ),
                              input("weights", weights)});
  }
  WarpSamples evaluate(const Warp& warp, const Points2& points, int order = 0) {
    return *plugin.evaluate(warp, {make_array<double>(points), order}).get<WarpSamples>();
  }
  Points2 at(const Warp& warp, const Points2& points) {
    return evaluate(warp, points).xy_px.matrix<2>();
  }
  double worst_error(const Warp& warp, const Points2& points, const Map& map) {
    const Points2 values = at(warp, points);
    double worst = 0.0;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      worst = std::max(worst, (values.row(i) - map(points(i, 0), points(i, 1))).norm());
    }
    return worst;
  }

  PluginUnderTest plugin;
  Template templ = testing::make_template(kSheet);
};

/// Expects that matches which determine no affine map give the map that they do determine, and that
/// the warp is flagged.
inline void expect_guesses(WarpBench& bench) {
  const Map similarity = [](double u, double v) {
    return Eigen::RowVector2d(200.0 + 0.4 * u - 0.3 * v, 20.0 + 0.3 * u + 0.4 * v);
  };
  const Map translation = [](double u, double v) { return Eigen::RowVector2d(u + 7.0, v - 12.0); };
  Points2 two(2, 2), elsewhere(3, 2);
  two << 100.0, 50.0, 700.0, 400.0;
  elsewhere << 0.0, 0.0, 900.0, 20.0, 300.0, 500.0;
  const auto expect = [&](const Points2& points, const Map& map) {
    const PluginAnswer outcome = bench.fit(matches_at(points, map));
    ASSERT_EQ(outcome.status, WEFT_DEGENERATE) << outcome.message;
    EXPECT_NE(outcome.message.find("guess"), std::string::npos) << outcome.message;
    EXPECT_LT(bench.worst_error(*outcome.get<Warp>(), elsewhere, map), 1e-6) << points.rows();
  };
  expect(two, similarity);
  expect(two.topRows(1), translation);
  expect(Points2::Constant(10, 2, 50.0), translation);
}

inline double diag(const Warp& warp, const char* name) { return warp.diag.value(name, -1.0); }

}  // namespace weft::testing
