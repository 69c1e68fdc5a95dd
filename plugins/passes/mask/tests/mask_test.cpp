// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::mask {
namespace {

constexpr std::uint64_t kSeed = 20241130;

/// A tilted flat surface with a printed pattern before a table. Every pixel's truth is known.
class Tabletop {
 public:
  explicit Tabletop(double table_grey = 90.0) : table_grey_(table_grey) {
    std::cout << "seed " << kSeed << "\n";
    const testing::SheetSpec spec{.columns = 10, .rows = 6};
    templ = testing::make_template(spec);
    for (std::int64_t v = 0; v < templ.texture.dim(0); ++v) {
      for (std::int64_t u = 0; u < templ.texture.dim(1); ++u) {
        templ.texture(v, u) = print(static_cast<double>(u), static_cast<double>(v));
      }
    }
    const testing::PoseSpec pose{0.7, 0.01, -0.01, 0.3, -0.2, 0.15};
    camera_from_template_ = testing::make_pose(spec, pose);
    const auto flat = testing::make_cylinder(spec, 1e9, 0.0, pose);
    shape.vertices_m = make_array<double>(testing::bent_vertices(templ, flat));
    shape.state = static_cast<std::int32_t>(ShapeState::estimated);
    shape.confidence = 1.0;
    shape.source = Array<std::uint8_t>({60}, 1);
    Rng rng(kSeed);
    matches =
        testing::draw_matches(templ, camera, flat, {.count = 100, .noise_px = 0.5}, rng).matches;
    image.stem = "000000";
    draw();
  }

  /// Draws the image anew; `stands_before` are the pixels of an occluder.
  void draw(const std::function<bool(double, double)>& stands_before = nullptr) {
    Rng rng(kSeed + 1);
    image.pixels = Array<std::uint8_t>({camera.height_px, camera.width_px}, 0);
    truth = Array<std::uint8_t>({camera.height_px, camera.width_px}, 0);
    for (std::int64_t y = 0; y < camera.height_px; ++y) {
      for (std::int64_t x = 0; x < camera.width_px; ++x) {
        double sum = 0.0;
        int inside = 0;
        for (int k = 0; k < 16; ++k) {
          const double px = static_cast<double>(x) + (k % 4 + 0.5) / 4.0 - 0.5;
          const double py = static_cast<double>(y) + (k / 4 + 0.5) / 4.0 - 0.5;
          const Eigen::Vector2d texel = texel_at(px, py);
          const bool is_sheet =
              texel.x() >= -0.5 && texel.y() >= -0.5 && texel.x() <= 959.5 && texel.y() <= 574.5;
          inside += is_sheet ? 1 : 0;
          const bool is_hidden = stands_before && stands_before(px, py);
          sum += is_hidden  ? 40.0
                 : is_sheet ? light_ * print(texel.x(), texel.y())
                            : table_grey_ + 10.0 * std::sin(0.05 * px) * std::cos(0.04 * py);
        }
        truth(y, x) = static_cast<std::uint8_t>(std::lround(255.0 * inside / 16.0));
        const double noisy = sum / 16.0 + 2.0 * rng.normal();
        image.pixels(y, x) = static_cast<std::uint8_t>(std::clamp(noisy, 0.0, 255.0));
      }
    }
  }

  testing::PluginAnswer run(const std::string& params = "{}", bool with_shape = true) const {
    // Answers live as long as the plugin.
    passes_.push_back(std::make_unique<testing::PluginUnderTest>("passes/mask", params));
    testing::PluginUnderTest& pass = *passes_.back();
    std::vector<testing::Input> inputs{testing::input("template", templ),
                                       testing::input("camera", camera),
                                       testing::input("image", image)};
    if (with_shape) inputs.push_back(testing::input("shape", shape));
    if (!with_shape) inputs.push_back(testing::input("correspondences", matches));
    return pass.process(0, inputs);
  }

  /// px, mean distance between the known outline of a mask and that of the truth, along rows.
  double outline_error_px(const ObjectMask& mask) const {
    double sum = 0.0, count = 0.0;
    for (std::int64_t y = 0; y < camera.height_px; ++y) {
      for (std::int64_t x = 1; x < camera.width_px; ++x) {
        if ((truth(y, x - 1) >= 128) == (truth(y, x) >= 128)) continue;
        const double true_px = crossing(truth, x, y);
        double nearest = 20.0;
        bool is_known = true;
        for (std::int64_t i = std::max(x - 20, std::int64_t{1});
             i < std::min(x + 20, camera.width_px); ++i) {
          is_known = is_known && mask.known(y, i) != 0;
          const bool ends = (mask.foreground(y, i - 1) >= 128) != (mask.foreground(y, i) >= 128);
          if (ends)
            nearest = std::min(nearest, std::abs(crossing(mask.foreground, i, y) - true_px));
        }
        if (!is_known) continue;
        sum += nearest;
        count += 1.0;
      }
    }
    EXPECT_GT(count, 50.0);
    return sum / count;
  }

  Camera camera = testing::make_camera();
  Template templ;
  Shape shape;
  Correspondences matches;
  Image image;
  Array<std::uint8_t> truth;  ///< [H,W] share of the surface, 0 to 255

 private:
  /// Blobs of ink on pale paper.
  static std::uint8_t print(double u, double v) {
    const double blobs = std::sin(0.05 * u) * std::sin(0.06 * v) + std::sin(0.021 * u + 0.033 * v);
    const bool is_margin = u < 60.0 || v < 60.0 || u > 900.0 || v > 515.0;
    return !is_margin && blobs > 0.6 ? 150 : 230;
  }
  static double crossing(const Array<std::uint8_t>& levels, std::int64_t x, std::int64_t y) {
    const double before = levels(y, x - 1), after = levels(y, x);
    return static_cast<double>(x) - 1.0 + (127.5 - before) / (after - before);
  }
  Eigen::Vector2d texel_at(double x_px, double y_px) const {
    const Eigen::Isometry3d back = camera_from_template_.inverse();
    const Eigen::Vector3d ray =
        back.linear() *
        Eigen::Vector3d((x_px - camera.cx) / camera.fx, (y_px - camera.cy) / camera.fy, 1.0);
    const Eigen::Vector3d from = back.translation();
    const Eigen::Vector3d hit = from - from.z() / ray.z() * ray;
    return {hit.x() / templ.m_per_px(0), hit.y() / templ.m_per_px(1)};
  }

  mutable std::vector<std::unique_ptr<testing::PluginUnderTest>> passes_;
  double table_grey_;
  double light_ = 0.85;
  Eigen::Isometry3d camera_from_template_;
};

ObjectMask given(const testing::PluginAnswer& out) {
  EXPECT_EQ(out.status, WEFT_OK) << out.message;
  return out.get<ObjectMask>().value_or(ObjectMask{});
}

TEST(Mask, HasTheOutlineOfTheSheet) {
  const Tabletop scene;
  const ObjectMask mask = given(scene.run());
  ASSERT_EQ(mask.foreground.dim(0), scene.camera.height_px);
  const double error_px = scene.outline_error_px(mask);
  std::cout << error_px << " px\n";
  EXPECT_LT(error_px, 0.7);
  EXPECT_LT(mask.diag.value("overlap", 1.0), 0.5);
}

TEST(Mask, FindsTheOutlineOfASheetWhoseShapeIsEightPixelsOff) {
  Tabletop scene;
  scene.shape.vertices_m.matrix<3>().col(0).array() += 8.0 * 0.7 / scene.camera.fx;
  const double error_px = scene.outline_error_px(given(scene.run()));
  std::cout << error_px << " px\n";
  EXPECT_LT(error_px, 0.9);
}

TEST(Mask, FindsTheOutlineFromMatchesAlone) {
  const Tabletop scene;
  const double error_px = scene.outline_error_px(given(scene.run("{}", false)));
  std::cout << error_px << " px\n";
  EXPECT_LT(error_px, 0.9);
}

TEST(Mask, KnowsNothingNextToAnOccluder) {
  Tabletop scene;
  scene.draw([](double x, double) { return x > 330.0 && x < 400.0; });
  const ObjectMask mask = given(scene.run());
  std::int64_t wrong = 0, unknown = 0;
  for (std::int64_t y = 0; y < scene.camera.height_px; ++y) {
    for (std::int64_t x = 331; x < 400; ++x) {
      if (scene.truth(y, x) < 250) continue;
      (mask.known(y, x) == 0 ? unknown : wrong) += 1;
    }
  }
  EXPECT_LT(wrong, unknown / 20);
  EXPECT_LT(scene.outline_error_px(mask), 0.9);
}

TEST(Mask, RefusesABackgroundOfTheColoursOfTheObject) {
  const Tabletop scene(0.85 * 228.0);
  const auto out = scene.run();
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  std::cout << out.message << "\n";
}

TEST(Mask, RefusesAShapeThatTheImageDoesNotShow) {
  Tabletop scene;
  for (std::int64_t i = 0; i < scene.image.pixels.size(); ++i) {
    scene.image.pixels.data()[i] = static_cast<std::uint8_t>(40 + (i * 7919) % 190);
  }
  EXPECT_EQ(scene.run().status, WEFT_NO_RESULT);
}

TEST(Mask, NeedsAShapeOrMatches) {
  Tabletop scene;
  std::fill_n(scene.matches.kept.data(), scene.matches.count(), std::uint8_t{0});
  EXPECT_EQ(scene.run("{}", false).status, WEFT_NO_RESULT);
}

TEST(Mask, IsTheSameWhateverOpenCvDrewBefore) {
  const Tabletop scene;
  cv::theRNG().state = 1;
  const ObjectMask first = given(scene.run());
  cv::theRNG().state = 2;
  const ObjectMask second = given(scene.run());
  EXPECT_EQ(cv::theRNG().state, 2U);
  EXPECT_TRUE(std::equal(first.foreground.data(), first.foreground.data() + first.foreground.size(),
                         second.foreground.data()));
}

TEST(Mask, OfAFolderIsWhatTheFilesSay) {
  const Tabletop scene;
  const std::string folder = ::testing::TempDir() + "weft_mask_files";
  std::filesystem::create_directories(folder);
  cv::Mat stored(480, 640, CV_8U, cv::Scalar(0));
  stored(cv::Rect(100, 50, 200, 150)).setTo(200);
  ASSERT_TRUE(cv::imwrite(folder + "/000000.png", stored));
  const ObjectMask mask = given(scene.run("{folder: " + folder + "}"));
  EXPECT_EQ(mask.foreground(60, 110), 200);
  EXPECT_EQ(mask.foreground(60, 99), 0);
  EXPECT_EQ(mask.known(0, 0), 1);
}

}  // namespace
}  // namespace weft::mask
