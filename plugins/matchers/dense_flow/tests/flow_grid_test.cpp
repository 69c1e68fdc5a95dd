// SPDX-License-Identifier: Apache-2.0
#include "../flow_grid.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <weft/data/matrix.hpp>

#include "common/view/tests/printed_scene.hpp"

namespace weft::dense_flow {
namespace {

constexpr int kGridSeed = 34;

TEST(FlowGrid, GivesTheSameForAnyNumberOfThreads) {
  std::cout << "seed " << kGridSeed << "\n";
  const view::PrintedScene scene;
  Rng rng(kGridSeed);
  const testing::PoseSpec pose{.distance_m = 0.55, .tilt_y_rad = 0.1};
  view::PredictedView predicted(0, true);
  predicted.load(scene.templ);
  const Shape shape = scene.shape_of(scene.bent(0.35, pose));
  ASSERT_TRUE(predicted.draw(scene.camera, shape.vertices_m.matrix<3>()));
  view::Pyramid image;
  image.load(scene.image_of(scene.bent(0.31, pose), rng).pixels);
  Workers workers;
  const auto nodes_of = [&](int threads) {
    FlowGrid grid;
    grid.find(predicted, image, Eigen::Vector2d::Zero(), {}, workers, threads);
    std::vector<Node> nodes;
    for (int row = 0; row < grid.rows(); ++row) {
      for (int column = 0; column < grid.columns(); ++column)
        nodes.push_back(grid.node(column, row));
    }
    return nodes;
  };
  const std::vector<Node> one = nodes_of(1);
  ASSERT_GT(one.size(), 1000U);
  for (const int threads : {2, 5}) {
    const std::vector<Node> several = nodes_of(threads);
    ASSERT_EQ(several.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(several[i].by_px, one[i].by_px) << threads;
      ASSERT_EQ(several[i].fate, one[i].fate) << threads;
    }
  }
}

}  // namespace
}  // namespace weft::dense_flow
