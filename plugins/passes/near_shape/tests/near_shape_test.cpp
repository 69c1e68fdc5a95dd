// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>
#include <string>
#include <vector>
#include <weft/data/image.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

using ::testing::HasSubstr;
using weft::Region;
using weft::testing::input;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

/// A flat surface of 10 x 6 vertices that faces the camera.
class NearShape : public ::testing::Test {
 protected:
  NearShape() {
    vertices_m_ = templ_.vertices_m.matrix<3>();
    vertices_m_.rowwise() += Eigen::RowVector3d(-0.15, -0.09, 0.8);
  }

  weft::Shape previous() const {
    weft::Shape shape;
    shape.vertices_m = weft::make_array<double>(vertices_m_);
    shape.source = weft::make_array<std::uint8_t>(
        Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 1>::Zero(vertices_m_.rows()));
    shape.confidence = 0.9;
    return shape;
  }

  PluginAnswer answer(const weft::Shape& shape, const std::string& params = "{}") {
    return run({input("previous.shape", shape)}, params);
  }
  PluginAnswer run(std::vector<weft::testing::Input> inputs, const std::string& params = "{}",
                   std::uint64_t frame = 0) {
    inputs.push_back(input("template", templ_));
    inputs.push_back(input("camera", camera_));
    plugins_.push_back(std::make_unique<PluginUnderTest>("passes/near_shape", params));
    return plugins_.back()->process(0, inputs, frame);
  }

  /// Matches that show the surface; with `kept` 0 a filter rejected them.
  weft::testing::Input matches(std::uint8_t kept) const {
    weft::Rng rng(1);
    auto drawn = weft::testing::draw_matches(templ_, camera_, vertices_m_, {.count = 9}, rng);
    std::fill_n(drawn.matches.kept.data(), drawn.matches.kept.size(), kept);
    return input("correspondences", drawn.matches);
  }

  /// Number of pixels in which a region is not the box, ends included.
  static int differences(const Region& region, const Eigen::AlignedBox2d& box) {
    int wrong = 0;
    for (std::int64_t y = 0; y < region.mask.dim(0); ++y) {
      for (std::int64_t x = 0; x < region.mask.dim(1); ++x) {
        const bool inside = box.contains(Eigen::Vector2d(double(x), double(y)));
        wrong += (region.mask(y, x) != 0) == inside ? 0 : 1;
      }
    }
    return wrong;
  }

  Region region(const std::string& params = "{}") {
    const PluginAnswer out = answer(previous(), params);
    EXPECT_EQ(out.status, WEFT_OK) << out.message;
    return out.get<Region>().value_or(Region{});
  }

  void expect_whole(const PluginAnswer& out, const std::string& why) const {
    EXPECT_EQ(out.status, WEFT_DEGENERATE);
    EXPECT_THAT(out.message, HasSubstr(why));
    EXPECT_THAT(out.message, HasSubstr("the whole image is searched"));
    const auto region = out.get<Region>();
    ASSERT_TRUE(region);
    const auto& mask = region->mask;
    EXPECT_EQ(mask.size(), camera_.height_px * camera_.width_px);
    EXPECT_EQ(std::count(mask.data(), mask.data() + mask.size(), 1), mask.size());
  }

  /// The box of the surface's corners.
  Eigen::AlignedBox2d box_px() const {
    Eigen::AlignedBox2d box;
    const weft::Points2 pixels = weft::project_points(weft::testing::pinhole(camera_), vertices_m_);
    for (Eigen::Index v = 0; v < pixels.rows(); ++v) box.extend(pixels.row(v).transpose());
    return box;
  }

  weft::Template templ_ = weft::testing::make_template();
  weft::Camera camera_ = weft::testing::make_camera();
  weft::Points3 vertices_m_;
  std::vector<std::unique_ptr<PluginUnderTest>> plugins_;  ///< answers live as long
};

TEST_F(NearShape, HoldsTheSurfaceAndItsMarginAndNothingElse) {
  for (const double margin : {0.0, 0.1, 0.3}) {
    const Region near = region("{margin: " + std::to_string(margin) + "}");
    Eigen::AlignedBox2d box = box_px();
    const double grown_px = margin * box.sizes().maxCoeff();
    const Eigen::Vector2d most = box.max().array() + grown_px;
    box.extend(Eigen::Vector2d(box.min().array() - grown_px)).extend(most);
    ASSERT_EQ(near.mask.dim(0), camera_.height_px);
    ASSERT_EQ(near.mask.dim(1), camera_.width_px);
    EXPECT_EQ(differences(near, box), 0) << margin;
  }
}

TEST_F(NearShape, IsOneStripOfTheSurfaceAFrameWhereMatchesShowIt) {
  const Eigen::AlignedBox2d box = box_px();
  for (std::uint64_t frame = 0; frame < 7; ++frame) {
    const PluginAnswer out =
        run({input("previous.shape", previous()), matches(1)}, "{margin: 0, parts: 3}", frame);
    ASSERT_EQ(out.status, WEFT_OK) << out.message;
    Eigen::AlignedBox2d strip = box;
    const double width_px = box.sizes().x() / 3.0;
    strip.min().x() += width_px * double(frame % 3);
    strip.max().x() = strip.min().x() + width_px;
    EXPECT_EQ(differences(*out.get<Region>(), strip), 0) << frame;
  }
}

TEST_F(NearShape, IsTheWholeImageWhereStripsAreSearchedAndNoMatchShowsTheSurface) {
  const std::string why = "no match shows the surface";
  expect_whole(answer(previous(), "{parts: 3}"), why);
  expect_whole(run({input("previous.shape", previous()), matches(0)}, "{parts: 3}"), why);
}

TEST_F(NearShape, LeavesOutTheCornersOfTheBoxOfATurnedSheet) {
  const Eigen::RowVector3d centre = vertices_m_.colwise().mean();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitZ()).matrix();
  vertices_m_ = ((vertices_m_.rowwise() - centre) * turn.transpose()).rowwise() + centre;
  const Region near = region("{margin: 0}");
  const Eigen::AlignedBox2d box = box_px();
  const auto at = [&](double x, double y) {
    return near.mask(static_cast<std::int64_t>(y), static_cast<std::int64_t>(x));
  };
  EXPECT_EQ(at(box.min().x() + 2, box.min().y() + 2), 0);
  EXPECT_EQ(at(box.max().x() - 2, box.max().y() - 2), 0);
  EXPECT_EQ(at(box.center().x(), box.center().y()), 1);
}

TEST_F(NearShape, EndsWhereTheImageDoes) {
  vertices_m_.col(0).array() -= 0.25;
  const Region near = region();
  const Eigen::AlignedBox2d box = box_px();
  ASSERT_LT(box.min().x(), 0.0);
  EXPECT_EQ(near.mask(static_cast<std::int64_t>(box.center().y()), 0), 1);
}

TEST_F(NearShape, IsTheWholeImageWithoutAShapeThatCanBeTrusted) {
  expect_whole(run({}), "there is no previous shape");
  weft::Shape shape = previous();
  shape.state = static_cast<std::int32_t>(weft::ShapeState::lost);
  expect_whole(answer(shape), "is lost");
  shape = previous();
  shape.state = static_cast<std::int32_t>(weft::ShapeState::predicted);
  shape.age_frames = 1;
  expect_whole(answer(shape), "was measured 1 frames before");
  EXPECT_EQ(answer(shape, "{longest_age: 2}").status, WEFT_OK);
  shape = previous();
  shape.confidence = 0.4;
  expect_whole(answer(shape), "not sure enough");
  EXPECT_EQ(answer(shape, "{least_confidence: 0.3}").status, WEFT_OK);
}

TEST_F(NearShape, IsTheWholeImageWhereTheShapeIsNotInIt) {
  vertices_m_.col(0).array() += 5.0;
  expect_whole(answer(previous()), "outside of the image");
  vertices_m_.col(2).array() -= 0.9;
  expect_whole(answer(previous()), "behind the camera");
}

TEST_F(NearShape, SaysThatAShapeIsOfAnotherTemplate) {
  vertices_m_.conservativeResize(40, 3);
  const PluginAnswer out = answer(previous());
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, HasSubstr("40"));
}

}  // namespace
