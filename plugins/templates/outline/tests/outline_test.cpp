// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <weft/data/matrix.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace {

using ::testing::HasSubstr;
using weft::Template;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

class OutlineTemplate : public ::testing::Test {
 protected:
  OutlineTemplate() {
    std::string pattern = (std::filesystem::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
  }
  ~OutlineTemplate() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::string write(const std::string& name, const cv::Mat& image) const {
    const std::string path = (folder_ / name).string();
    if (!cv::imwrite(path, image)) throw std::runtime_error("cannot write " + name);
    return path;
  }

  PluginAnswer build(const std::string& photo, const std::string& more) {
    plugins_.push_back(std::make_unique<PluginUnderTest>("templates/outline",
                                                         "{photo: '" + photo + "', " + more + "}"));
    return plugins_.back()->process(0, {});
  }

  Template built(const std::string& photo, const std::string& more) {
    const PluginAnswer outcome = build(photo, more);
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
    auto templ = outcome.get<Template>();
    if (!templ) throw std::runtime_error("no template");
    return *std::move(templ);
  }

  /// A blue ellipse of 300 x 160 px on a light table.
  static cv::Mat ellipse() {
    cv::Mat photo(300, 420, CV_8UC3, cv::Scalar(238, 236, 240));
    cv::ellipse(photo, {210, 150}, {150, 80}, 0.0, 0.0, 360.0, cv::Scalar(160, 70, 30), cv::FILLED);
    return photo;
  }

  std::filesystem::path folder_;
  std::vector<std::unique_ptr<PluginUnderTest>> plugins_;  // the templates live in them
};

Eigen::RowVector3d extent(const Template& templ) {
  const auto vertices = templ.vertices_m.matrix<3>();
  return vertices.colwise().maxCoeff() - vertices.colwise().minCoeff();
}

TEST_F(OutlineTemplate, HasTheSizeOfTheObjectAndNotOfThePhotograph) {
  const std::string photo = write("p.png", ellipse());
  for (const std::string known : {"longest", "width"}) {
    const Template templ = built(photo, "length_m: 0.3, length_of: " + known);
    EXPECT_NEAR(extent(templ).x(), 0.3, 0.003) << known;
    EXPECT_NEAR(extent(templ).y(), 0.16, 0.003) << known;
    EXPECT_EQ(extent(templ).z(), 0.0);
    EXPECT_NEAR(templ.m_per_px(0), 0.001, 1e-5);
  }
  EXPECT_NEAR(built(photo, "length_m: 0.16, length_of: height").m_per_px(0), 0.001, 2e-5);
  EXPECT_DOUBLE_EQ(built(photo, "length_m: 0.42, length_of: picture").m_per_px(1), 0.001);
}

TEST_F(OutlineTemplate, LiesOverItsTextureWithTheMetricOfATexel) {
  const Template templ = built(write("p.png", ellipse()), "length_m: 0.3");
  ASSERT_EQ(templ.texture.dim(0), 300);
  ASSERT_EQ(templ.texture.dim(1), 420);
  EXPECT_EQ(templ.mask(150, 210), 1);
  EXPECT_EQ(templ.mask(10, 10), 0);
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) {
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_DOUBLE_EQ(templ.vertices_m(v, axis), templ.m_per_px(axis) * templ.flat_px(v, axis));
    }
    const double across = (templ.flat_px(v, 0) - 210.0) / 151.0;
    const double down = (templ.flat_px(v, 1) - 150.0) / 81.0;
    EXPECT_LE(across * across + down * down, 1.02);
  }
}

TEST_F(OutlineTemplate, HasAboutAsManyVerticesAsAsked) {
  const std::string photo = write("p.png", ellipse());
  for (const int vertices : {40, 400}) {
    const auto count =
        built(photo, "length_m: 0.3, vertices: " + std::to_string(vertices)).vertices_m.rows();
    EXPECT_GT(static_cast<double>(count), 0.75 * vertices);
    EXPECT_LT(static_cast<double>(count), 1.6 * vertices);
  }
  EXPECT_GT(built(photo, "length_m: 0.3, spacing_mm: 10").vertices_m.rows(),
            2 * built(photo, "length_m: 0.3, spacing_mm: 20").vertices_m.rows());
}

TEST_F(OutlineTemplate, IsTheSameInEveryBuild) {
  const std::string photo = write("p.png", ellipse());
  const Template one = built(photo, "length_m: 0.3"), other = built(photo, "length_m: 0.3");
  ASSERT_EQ(one.faces.size(), other.faces.size());
  EXPECT_TRUE(
      std::equal(one.faces.data(), one.faces.data() + one.faces.size(), other.faces.data()));
  EXPECT_TRUE(std::equal(one.flat_px.data(), one.flat_px.data() + one.flat_px.size(),
                         other.flat_px.data()));
}

TEST_F(OutlineTemplate, TakesTheOutlineFromAMaskOrFromTransparency) {
  cv::Mat mask = cv::Mat::zeros(300, 420, CV_8UC1);
  mask(cv::Rect(100, 50, 200, 200)) = 255;
  const std::string square = write("mask.png", mask);
  const Template masked =
      built(write("p.png", ellipse()), "mask: '" + square + "', length_m: 0.2, length_of: width");
  EXPECT_NEAR(extent(masked).y(), 0.2, 0.001);

  cv::Mat channels[4];
  cv::split(ellipse(), channels);
  channels[3] = mask;
  cv::Mat transparent;
  cv::merge(channels, 4, transparent);
  const Template cut = built(write("t.png", transparent), "length_m: 0.2, length_of: width");
  EXPECT_NEAR(extent(cut).y(), 0.2, 0.001);
  EXPECT_EQ(cut.texture.ndim(), 3);
}

TEST_F(OutlineTemplate, SaysThatAnObjectMayBeCutOff) {
  cv::Mat photo(300, 420, CV_8UC3, cv::Scalar(238, 236, 240));
  cv::circle(photo, {40, 150}, 90, cv::Scalar(160, 70, 30), cv::FILLED);
  const PluginAnswer outcome = build(write("cut.png", photo), "length_m: 0.1");
  EXPECT_EQ(outcome.status, WEFT_DEGENERATE);
  EXPECT_THAT(outcome.message, HasSubstr("reaches the border"));
  EXPECT_TRUE(outcome.get<Template>());
}

TEST_F(OutlineTemplate, RefusesAnObjectInSeveralParts) {
  cv::Mat photo = ellipse();
  for (int x = 120; x < 290; x += 12) {
    for (int y = 100; y < 190; y += 12) {  // parts that are printed as light as the table
      cv::rectangle(photo, {x, y, 9, 9}, cv::Scalar(238, 236, 240), cv::FILLED);
    }
  }
  const std::string path = write("print.png", photo);
  const PluginAnswer outcome = build(path, "length_m: 0.3, smallest_hole: 0");
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_THAT(outcome.message, HasSubstr("print.png: the object breaks into pieces: "));
  EXPECT_THAT(outcome.message, HasSubstr("smallest_hole: 1 fills the holes"));
  EXPECT_LT(built(path, "length_m: 0.3, smallest_hole: 1").vertices_m.rows(), 200);
}

TEST_F(OutlineTemplate, ABeltOfOneRowOfFacesIsWhole) {
  cv::Mat photo(120, 700, CV_8UC3, cv::Scalar(238, 236, 240));
  cv::rectangle(photo, {50, 50, 600, 12}, cv::Scalar(160, 70, 30), cv::FILLED);
  const Template templ = built(write("belt.png", photo), "length_m: 0.6, spacing_mm: 14");
  EXPECT_GT(templ.faces.rows(), 80);
}

TEST_F(OutlineTemplate, SaysWhatToChangeWhenThereIsNoOutline) {
  const cv::Mat table(300, 420, CV_8UC3, cv::Scalar(238, 236, 240));
  const std::string empty = write("table.png", table), photo = write("p.png", ellipse());
  const std::string black = write("black.png", cv::Mat::zeros(300, 420, CV_8UC1));
  const std::string small = write("small.png", cv::Mat::zeros(30, 42, CV_8UC1));
  const std::vector<std::pair<PluginAnswer, std::string>> cases{
      {build(empty, "length_m: 0.1"), "table.png: no object stands out"},
      {build(photo, "length_m: 0.1, mask: '" + black + "'"), "mask of the object is empty"},
      {build(photo, "length_m: 0.1, mask: '" + small + "'"), "size of the photograph, 420 x 300"},
      {build(photo, "length_m: 0.1, spacing_mm: 0.001"), "'spacing_mm' requires edges"},
      {build(photo, "length_m: 0.1, vertices: 100000"), "'vertices' requires edges"}};
  for (const auto& [outcome, reason] : cases) {
    EXPECT_EQ(outcome.status, WEFT_ERROR) << reason;
    EXPECT_THAT(outcome.message, HasSubstr(reason));
  }
  EXPECT_THROW(build(photo, "length_m: 0"), std::runtime_error);
  EXPECT_THROW(build(photo, "length_m: -1"), std::runtime_error);
  EXPECT_THROW(build(photo, "vertices: 10"), std::runtime_error);
}

}  // namespace
