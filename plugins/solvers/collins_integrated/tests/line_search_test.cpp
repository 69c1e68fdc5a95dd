// SPDX-License-Identifier: Apache-2.0
#include "../texture/line_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>

#include "printed_scene.hpp"

namespace weft::collins_integrated {
namespace {

/// A surface, an image of it and its samples, which stay as they were generated.
struct Drawn {
  PrintedScene scene;
  DevelopableSheet truth = scene.bent(0.3, {.distance_m = 0.55, .tilt_y_rad = 0.2});
  Rng rng{kSeed};
  Image image = scene.image_of(truth, rng);
  Pinhole camera = testing::pinhole(scene.camera);
  Pyramid texture, pyramid;
  std::vector<Sample> samples;
  LineSearch search;

  Drawn() {
    std::cout << "seed " << kSeed << "\n";
    texture.load(scene.templ.texture, 12);
    pyramid.load(image.pixels, 3);
    EXPECT_TRUE(choose_samples(scene.templ, texture, scene.camera, 500, samples));
    search.load(scene.templ, texture);
  }

  Eigen::Vector2d place_px(const Sample& sample) const {
    return project(camera, truth.at(scene.templ.m_per_px(0) * sample.template_px.x(),
                                    scene.templ.m_per_px(1) * sample.template_px.y()));
  }

  struct Outcome {
    std::vector<double> off_px;  ///< along the normals, of what is found
    int found = 0, compared = 0;
  };
  Outcome look(const DevelopableSheet& from, const LineSearchOptions& options) {
    const Points3 vertices_m = testing::bent_vertices(scene.templ, from);
    Outcome outcome;
    for (const Sample& sample : samples) {
      const Sighting sighting = search.look(pyramid, camera, vertices_m, sample, options);
      outcome.compared += sighting.look == Look::found || sighting.look == Look::unlike ? 1 : 0;
      if (sighting.look != Look::found) continue;
      ++outcome.found;
      EXPECT_NEAR(sighting.normal.norm(), 1.0, 1e-9);
      outcome.off_px.push_back(std::abs(sighting.normal.dot(sighting.seen_px - place_px(sample))));
    }
    return outcome;
  }
};

TEST(Samples, LieOnEdgesOfThePrintAllOverTheSheet) {
  Drawn drawn;
  EXPECT_GT(drawn.samples.size(), 350U);
  std::vector<int> by_quarter(4, 0);
  const auto flat_px = drawn.scene.templ.flat_px.matrix<2>();
  const auto faces = drawn.scene.templ.faces.matrix<3>();
  for (const Sample& sample : drawn.samples) {
    Eigen::RowVector2d place = Eigen::RowVector2d::Zero();
    for (Eigen::Index k = 0; k < 3; ++k) {
      place += sample.weights[k] * flat_px.row(faces(sample.face, k));
    }
    EXPECT_LT((place.transpose() - sample.template_px).norm(), 1e-9);
    ++by_quarter[(sample.template_px.x() > 450.0 ? 1U : 0U) +
                 (sample.template_px.y() > 270.0 ? 2U : 0U)];
  }
  EXPECT_GT(*std::min_element(by_quarter.begin(), by_quarter.end()), 70);
}

TEST(LineSearch, FindsEdgesToATenthOfAPixelAlongTheirNormals) {
  Drawn drawn;
  // The shape is 1 px to the side.
  const DevelopableSheet from =
      drawn.scene.bent(0.3, {.distance_m = 0.55, .x_m = 0.0007, .tilt_y_rad = 0.2});
  const Drawn::Outcome outcome = drawn.look(from, {0, 6, 0.8F});
  std::cout << outcome.found << " of " << outcome.compared << " found, median "
            << median(outcome.off_px) << " px off\n";
  EXPECT_GT(outcome.found, 200);
  EXPECT_LT(median(outcome.off_px), 0.15);
  EXPECT_LT(percentile(outcome.off_px, 90.0), 1.0);
}

TEST(LineSearch, FindsWhatIsFurtherAwayInAHalvedImage) {
  Drawn drawn;
  const DevelopableSheet from =
      drawn.scene.bent(0.3, {.distance_m = 0.55, .x_m = 0.008, .y_m = 0.004, .tilt_y_rad = 0.2});
  const Drawn::Outcome fine = drawn.look(from, {0, 6, 0.7F}),
                       coarse = drawn.look(from, {2, 6, 0.7F});
  const auto share_near = [](const Drawn::Outcome& outcome) {
    const auto near = std::count_if(outcome.off_px.begin(), outcome.off_px.end(),
                                    [](double off_px) { return off_px < 3.0; });
    return static_cast<double>(near) / static_cast<double>(outcome.off_px.size());
  };
  std::cout << "near: " << share_near(fine) << ", halved twice " << share_near(coarse) << "\n";
  EXPECT_GT(share_near(coarse), 0.6);
  EXPECT_GT(share_near(coarse), 1.5 * share_near(fine));
}

TEST(LineSearch, DoesNotMindBrightnessAndContrast) {
  Drawn drawn;
  const Drawn::Outcome plain = drawn.look(drawn.truth, {0, 6, 0.8F});
  for (std::uint8_t& pixel :
       std::span(drawn.image.pixels.data(), to_index(drawn.image.pixels.size()))) {
    pixel = static_cast<std::uint8_t>(70.0 + 0.5 * pixel);
  }
  drawn.pyramid.load(drawn.image.pixels, 3);
  const Drawn::Outcome dim = drawn.look(drawn.truth, {0, 6, 0.8F});
  EXPECT_GT(dim.found, 0.95 * plain.found);
  EXPECT_LT(median(dim.off_px), 1.1 * median(plain.off_px) + 0.01);
}

TEST(LineSearch, FindsNextToNothingInNoiseOrOnABack) {
  Drawn drawn;
  const int on_sheet = drawn.look(drawn.truth, {0, 6, 0.8F}).found;
  const DevelopableSheet from_behind =
      drawn.scene.bent(0.3, {.distance_m = 0.55, .tilt_y_rad = 3.1});
  EXPECT_EQ(drawn.look(from_behind, {0, 6, 0.0F}).compared, 0);
  for (std::int64_t i = 0; i < drawn.image.pixels.size(); ++i) {
    drawn.image.pixels.data()[i] = static_cast<std::uint8_t>(drawn.rng.uniform(0.0, 255.0));
  }
  drawn.pyramid.load(drawn.image.pixels, 3);
  const Drawn::Outcome noise = drawn.look(drawn.truth, {0, 6, 0.8F});
  EXPECT_GT(noise.compared, 300);
  EXPECT_LT(noise.found, 0.02 * on_sheet);
}

}  // namespace
}  // namespace weft::collins_integrated
