// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <stdlib.h>

#include <Eigen/Dense>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <weft/data/matrix.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/mistakes.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using weft::Template;
using weft::testing::mistakes_of;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

/// A pattern in which no two neighbours are alike.
void fill(cv::Mat& image) {
  for (std::uint8_t* value = image.data; value < image.dataend; ++value) {
    *value = static_cast<std::uint8_t>((value - image.data) * 2654435761U >> 24U);
  }
}

class RectangularTemplate : public ::testing::Test {
 protected:
  RectangularTemplate() {
    std::string pattern = (std::filesystem::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
  }
  ~RectangularTemplate() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string write(const std::string& name, const cv::Mat& image) const {
    if (!cv::imwrite(path(name), image)) throw std::runtime_error("cannot write " + name);
    return path(name);
  }

  std::string write_text(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }

  /// Params: the texture and, after it, `more`.
  PluginAnswer build(const std::string& texture, const std::string& more) {
    plugins_.push_back(std::make_unique<PluginUnderTest>(
        "templates/rectangular", "{texture: '" + texture + "'" + more + "}"));
    return plugins_.back()->process(0, {});
  }

  Template built(const std::string& texture, const std::string& more) {
    const PluginAnswer outcome = build(texture, more);
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
    auto templ = outcome.get<Template>();
    if (!templ) throw std::runtime_error("no template");
    return *std::move(templ);
  }

 private:
  std::filesystem::path folder_;
  std::vector<std::unique_ptr<PluginUnderTest>> plugins_;  // the templates live in them
};

TEST_F(RectangularTemplate, HasTheNumbersOfFacesAndEdgesOfAGrid) {
  const std::string texture = write("t.png", cv::Mat::zeros(60, 90, CV_8UC1));
  const Template templ = built(texture, ", width_m: 0.3, columns: 10, rows: 6");
  ASSERT_EQ(templ.vertices_m.rows(), 60);
  ASSERT_EQ(templ.faces.rows(), 2 * 9 * 5);
  const auto topology = weft::build_topology(templ.faces.matrix<3>(), 60);
  ASSERT_TRUE(topology);
  EXPECT_EQ(topology->edges.rows(), 149);
  EXPECT_EQ(topology->boundary_edges.size(), 28U);
  EXPECT_EQ(topology->bending_pairs.rows(), 121);
}

TEST_F(RectangularTemplate, SpansTheTextureFromEdgeToEdge) {
  const std::string texture = write("t.png", cv::Mat::zeros(40, 100, CV_8UC1));
  const Template templ = built(texture, ", width_m: 0.2, columns: 5, rows: 3");
  EXPECT_DOUBLE_EQ(templ.flat_px(0, 0), -0.5);
  EXPECT_DOUBLE_EQ(templ.flat_px(0, 1), -0.5);
  EXPECT_DOUBLE_EQ(templ.flat_px(14, 0), 99.5);
  EXPECT_DOUBLE_EQ(templ.flat_px(14, 1), 39.5);
  EXPECT_DOUBLE_EQ(templ.flat_px(6, 0), 24.5);
  EXPECT_DOUBLE_EQ(templ.flat_px(6, 1), 19.5);
  EXPECT_NEAR(templ.vertices_m(14, 0) - templ.vertices_m(0, 0), 0.2, 1e-15);
  EXPECT_NEAR(templ.vertices_m(14, 1) - templ.vertices_m(0, 1), 0.08, 1e-15);
}

TEST_F(RectangularTemplate, CountsFromTheCentreOfTheFirstTexelWhenAsked) {
  // The paper of the Kinect paper sequence: 420 x 297 mm at 2 px a mm, 15 x 11 vertices.
  const std::string texture = write("t.png", cv::Mat::zeros(594, 840, CV_8UC3));
  const Template templ =
      built(texture, ", width_m: 0.42, columns: 15, rows: 11, texel_origin: centre");
  EXPECT_DOUBLE_EQ(templ.m_per_px(0), 0.0005);
  EXPECT_DOUBLE_EQ(templ.m_per_px(1), 0.0005);
  for (std::int64_t v = 0; v < 165; ++v) {
    EXPECT_EQ(templ.flat_px(v, 0), 60.0 * static_cast<double>(v % 15));
    EXPECT_DOUBLE_EQ(templ.flat_px(v, 1), 59.4 * static_cast<double>(v / 15));
    EXPECT_DOUBLE_EQ(templ.vertices_m(v, 0), 0.0005 * templ.flat_px(v, 0));
    EXPECT_DOUBLE_EQ(templ.vertices_m(v, 1), 0.0005 * templ.flat_px(v, 1));
    EXPECT_EQ(templ.vertices_m(v, 2), 0.0);
  }
}

TEST_F(RectangularTemplate, EveryFaceHasTheMetricOfTheTexelsAndFacesTheCamera) {
  const std::string texture = write("t.png", cv::Mat::zeros(50, 80, CV_8UC1));
  const Template templ = built(texture, ", width_m: 0.4, height_m: 0.15, columns: 6, rows: 4");
  Eigen::Matrix<double, 3, 2> pitch = Eigen::Matrix<double, 3, 2>::Zero();
  pitch(0, 0) = 0.4 / 80;
  pitch(1, 1) = 0.15 / 50;
  EXPECT_DOUBLE_EQ(templ.m_per_px(0), pitch(0, 0));
  EXPECT_DOUBLE_EQ(templ.m_per_px(1), pitch(1, 1));
  const auto flat = templ.flat_px.matrix<2>();
  const auto rest = templ.vertices_m.matrix<3>();
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    const int a = templ.faces(f, 0), b = templ.faces(f, 1), c = templ.faces(f, 2);
    Eigen::Matrix2d sides_px;
    sides_px << (flat.row(b) - flat.row(a)).transpose(), (flat.row(c) - flat.row(a)).transpose();
    Eigen::Matrix<double, 3, 2> sides_m;
    sides_m << (rest.row(b) - rest.row(a)).transpose(), (rest.row(c) - rest.row(a)).transpose();
    EXPECT_TRUE((sides_m * sides_px.inverse()).isApprox(pitch, 1e-12));
    EXPECT_LT(sides_px.determinant(), 0.0);
  }
}

TEST_F(RectangularTemplate, AlternatesTheDiagonals) {
  const std::string texture = write("t.png", cv::Mat::zeros(20, 20, CV_8UC1));
  const Template templ = built(texture, ", width_m: 0.1, columns: 3, rows: 3");
  const auto topology = weft::build_topology(templ.faces.matrix<3>(), 9);
  ASSERT_TRUE(topology);
  int at_centre = 0;
  for (Eigen::Index e = 0; e < topology->edges.rows(); ++e) {
    at_centre += topology->edges(e, 0) == 4 || topology->edges(e, 1) == 4 ? 1 : 0;
  }
  EXPECT_EQ(at_centre, 8);  // four sides and four diagonals; all parallel would give six
}

TEST_F(RectangularTemplate, KeepsTheTextureAndMakesAMask) {
  cv::Mat colour(7, 9, CV_8UC3), transparent(7, 9, CV_8UC4);
  fill(colour);
  fill(transparent);
  const Template opaque = built(write("c.png", colour), ", width_m: 0.1");
  EXPECT_EQ(opaque.texture.ndim(), 3);
  EXPECT_TRUE(std::equal(colour.datastart, colour.dataend, opaque.texture.data()));
  EXPECT_TRUE(std::all_of(opaque.mask.data(), opaque.mask.data() + 63,
                          [](std::uint8_t m) { return m == 1; }));

  const Template masked = built(write("a.png", transparent), ", width_m: 0.1");
  EXPECT_EQ(masked.texture.ndim(), 3);
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 9; ++x) {
      EXPECT_EQ(masked.mask(y, x), transparent.at<cv::Vec4b>(y, x)[3] >= 128 ? 1 : 0);
      EXPECT_EQ(masked.texture(y, 3 * x + 1), transparent.at<cv::Vec4b>(y, x)[1]);
    }
  }
  const Template grey = built(write("g.png", cv::Mat::ones(7, 9, CV_8UC1)), ", width_m: 0.1");
  EXPECT_EQ(grey.texture.ndim(), 2);
}

TEST_F(RectangularTemplate, SaysWhatToChangeWhenTheTextureIsUnusable) {
  EXPECT_THROW(build(path("missing.png"), ", width_m: 0.1"), std::runtime_error);
  const std::vector<std::pair<std::string, std::string>> cases{
      {path(""), "it is a folder"},
      {write_text("text.png", "no image"), "no image"},
      {write_text("empty.png", ""), "empty"},
      {write("deep.png", cv::Mat::zeros(4, 4, CV_16UC1)), "8 bits"},
      {write("clear.png", cv::Mat::zeros(4, 4, CV_8UC4)), "transparent everywhere"}};
  for (const auto& [texture, reason] : cases) {
    const PluginAnswer outcome = build(texture, ", width_m: 0.1");
    EXPECT_EQ(outcome.status, WEFT_ERROR) << texture;
    EXPECT_THAT(outcome.message, AllOf(HasSubstr(texture), HasSubstr(reason)));
    EXPECT_THAT(mistakes_of("templates/rectangular", "{texture: '" + texture + "', width_m: 1}"),
                ::testing::ElementsAre("texture: " + outcome.message));
  }
}

TEST_F(RectangularTemplate, RefusesImpossibleSizes) {
  const std::string texture = write("t.png", cv::Mat::zeros(4, 4, CV_8UC1));
  EXPECT_THROW(build(texture, ""), std::runtime_error);
  EXPECT_THROW(build(texture, ", width_m: 0"), std::runtime_error);
  EXPECT_THROW(build(texture, ", width_m: -0.1"), std::runtime_error);
  EXPECT_THROW(build(texture, ", width_m: 0.1, height_m: -0.1"), std::runtime_error);
  EXPECT_THROW(build(texture, ", width_m: 0.1, columns: 1"), std::runtime_error);
  EXPECT_THROW(build(texture, ", width_m: 0.1, rows: 1"), std::runtime_error);
  EXPECT_THROW(build(texture, ", width_m: 0.1, texel_origin: corner"), std::runtime_error);
}

}  // namespace
