// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

namespace fs = std::filesystem;
using weft::Array;
using weft::Template;
using weft::testing::input;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kOpen = 0, kWrite = 1, kFinish = 2;

class DrawingTest : public ::testing::Test {
 protected:
  DrawingTest() {
    std::string pattern = (fs::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
  }
  ~DrawingTest() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  PluginAnswer write(const Template& templ, const std::string& more) const {
    PluginUnderTest sink("sinks/drawing",
                         "{path: '" + (folder_ / "it.png").string() + "'" + more + "}");
    static_cast<void>(sink.process(kOpen, {}));
    PluginAnswer outcome = sink.process(kWrite, {input("template", templ)});
    static_cast<void>(sink.process(kFinish, {}));
    return outcome;
  }
  cv::Mat drawn(const Template& templ, const std::string& more = {}) const {
    const PluginAnswer outcome = write(templ, more);
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
    return cv::imread((folder_ / "it.png").string(), cv::IMREAD_UNCHANGED);
  }

  fs::path folder_;
};

/// 800 x 400 texels, 5 x 3 vertices; grey 100, and the right half is not the object.
Template half_sheet() {
  Template sheet = weft::testing::make_template({5, 3, 0.4, 0.2, 800, 400});
  std::fill_n(sheet.texture.data(), sheet.texture.size(), std::uint8_t{100});
  for (int v = 0; v < 400; ++v) std::fill_n(sheet.mask.row(v) + 400, 400, std::uint8_t{0});
  return sheet;
}

TEST_F(DrawingTest, ShowsTheMeshOverATextureThatIsPaleOutsideTheMask) {
  const cv::Mat picture = drawn(half_sheet());
  ASSERT_EQ(picture.size(), cv::Size(800, 400));
  ASSERT_EQ(picture.type(), CV_8UC3);
  // Edges run along u = 200 k and v = 200 k and through the diagonals of cells.
  EXPECT_EQ(picture.at<cv::Vec3b>(60, 80), cv::Vec3b(100, 100, 100)) << "inside a face";
  EXPECT_EQ(picture.at<cv::Vec3b>(60, 680), cv::Vec3b(193, 193, 193)) << "100 + 0.6 * 155";
  const auto greenness = [&](int v, int u) {
    const auto colour = picture.at<cv::Vec3b>(v, u);
    return static_cast<int>(colour[1]) - colour[2];
  };
  for (const int u : {200, 400, 600}) {
    EXPECT_GT(std::max(greenness(60, u - 1), greenness(60, u)), 80) << u;
  }
  EXPECT_GT(std::max(greenness(199, 80), greenness(200, 80)), 80);
  EXPECT_EQ(greenness(60, 210), 0) << "lines are thin";
}

TEST_F(DrawingTest, ShowsAnObjectThatIsNotFlatBesideItsTexture) {
  Template sheet = half_sheet();
  for (Eigen::Index v = 0; v < sheet.vertices_m.rows(); ++v) {
    sheet.vertices_m(v, 2) = 0.5 * std::pow(sheet.vertices_m(v, 0), 2);
  }
  const cv::Mat picture = drawn(sheet);
  ASSERT_EQ(picture.size(), cv::Size(800 + 480, 480));
  const cv::Mat object = picture(cv::Rect(800, 0, 480, 480));
  EXPECT_EQ(object.at<cv::Vec3b>(2, 2), cv::Vec3b(255, 255, 255));
  const auto middle = object.at<cv::Vec3b>(240, 250);
  EXPECT_LE(middle[2], 100) << "a shaded face of grey 100, or its border";
}

TEST_F(DrawingTest, WritesTheTextureTexelForPixel) {
  for (const bool is_grey : {true, false}) {
    Template sheet = half_sheet();
    if (!is_grey) sheet.texture = Array<std::uint8_t>({400, 800, 3}, 0);
    for (std::int64_t i = 0; i < sheet.texture.size(); ++i) {
      sheet.texture.data()[i] = static_cast<std::uint8_t>(i * 7 % 251);
    }
    const cv::Mat picture = drawn(sheet, ", content: texture");
    ASSERT_EQ(picture.channels(), is_grey ? 1 : 3);
    ASSERT_TRUE(picture.isContinuous());
    EXPECT_TRUE(std::equal(sheet.texture.data(), sheet.texture.data() + sheet.texture.size(),
                           picture.data));
  }
}

TEST_F(DrawingTest, IsWrittenOnce) {
  PluginUnderTest sink("sinks/drawing", "{path: '" + (folder_ / "it.png").string() + "'}");
  static_cast<void>(sink.process(kOpen, {}));
  const std::vector<weft::testing::Input> inputs{input("template", half_sheet())};
  ASSERT_EQ(sink.process(kWrite, inputs).status, WEFT_OK);
  ASSERT_TRUE(fs::remove(folder_ / "it.png"));
  ASSERT_EQ(sink.process(kWrite, inputs).status, WEFT_OK);
  EXPECT_FALSE(fs::exists(folder_ / "it.png"));
}

TEST_F(DrawingTest, SaysWhichFileCannotBeWritten) {
  fs::create_directories(folder_ / "it.png");
  const PluginAnswer outcome = write(half_sheet(), "");
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_THAT(outcome.message, ::testing::HasSubstr("cannot be written"));
}

TEST_F(DrawingTest, ShowsHowFarMatchesAreOffTheirPlacesOnTheShape) {
  const Template sheet = weft::testing::make_template({5, 3, 0.4, 0.2, 800, 400});
  const weft::Camera camera = weft::testing::make_camera();
  weft::Shape shape;
  shape.vertices_m = weft::Array<double>({15, 3});
  for (int v = 0; v < 15; ++v) {
    shape.vertices_m(v, 0) = sheet.vertices_m(v, 0) - 0.2;
    shape.vertices_m(v, 1) = sheet.vertices_m(v, 1) - 0.1;
    shape.vertices_m(v, 2) = 1.0;
  }
  shape.source = weft::Array<std::uint8_t>({15}, 1);
  weft::Image image;
  image.pixels = weft::Array<std::uint8_t>({camera.height_px, camera.width_px}, 100);
  image.stem = "a";
  // On the first corner of the first face, but seen 40 px to the right of it.
  const double right_px = camera.cx + camera.fx * shape.vertices_m(sheet.faces(0, 0), 0) + 40.0;
  const double down_px = camera.cy + camera.fy * shape.vertices_m(sheet.faces(0, 0), 1);
  weft::Correspondences matches;
  matches.template_px = weft::Array<double>({1, 2}, 0.0);
  matches.image_px = weft::Array<double>({1, 2});
  matches.image_px(0, 0) = right_px, matches.image_px(0, 1) = down_px;
  matches.face = weft::Array<std::int32_t>({1}, 0);
  matches.barycentrics = weft::Array<double>({1, 3}, 0.0);
  matches.barycentrics(0, 0) = 1.0;
  matches.kept = weft::Array<std::uint8_t>({1}, 1);
  matches.score = weft::Array<double>({1}, 1.0);
  PluginUnderTest sink("sinks/drawing",
                       "{path: '" + (folder_ / "it.png").string() + "', content: matches}");
  static_cast<void>(sink.process(kOpen, {}));
  EXPECT_EQ(sink.process(kWrite, {input("template", sheet)}).status, WEFT_OK);
  EXPECT_FALSE(fs::exists(folder_ / "it.png")) << "there is no shape yet";
  const PluginAnswer outcome = sink.process(
      kWrite, {input("template", sheet), input("image", image), input("camera", camera),
               input("correspondences", matches), input("shape", shape)});
  EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const cv::Mat picture = cv::imread((folder_ / "it.png").string());
  ASSERT_EQ(picture.cols, camera.width_px);
  const auto redness = [&](double x, double y) {
    const auto colour =
        picture.at<cv::Vec3b>(static_cast<int>(std::lround(y)), static_cast<int>(std::lround(x)));
    return static_cast<int>(colour[2]) - colour[0];
  };
  // Half-way between, beside the edge that runs there in another colour.
  int most = -255;
  for (int y = -2; y <= 2; ++y) most = std::max(most, redness(right_px - 10.0, down_px + y));
  EXPECT_GT(most, 100);
  EXPECT_LT(std::abs(redness(20.0, 20.0)), 3);
}

TEST_F(DrawingTest, ShowsKeypointsThatLookAlikeAndThoseThatDoNot) {
  const Template sheet = half_sheet();
  weft::Correspondences pairs;
  pairs.template_px = weft::Array<double>({2, 2}, 100.0);
  pairs.image_px = weft::Array<double>({2, 2}, 100.0);
  pairs.template_px(1, 0) = 300.0;
  pairs.image_px(1, 0) = 380.0;
  pairs.face = weft::Array<std::int32_t>({2}, -1);
  pairs.barycentrics = weft::Array<double>({2, 3}, 0.0);
  pairs.kept = weft::Array<std::uint8_t>({2}, 0);
  pairs.kept(1) = 1;
  pairs.score = weft::Array<double>({2}, 1.0);
  PluginUnderTest sink("sinks/drawing",
                       "{path: '" + (folder_ / "it.png").string() + "', content: twins}");
  static_cast<void>(sink.process(kOpen, {}));
  const PluginAnswer outcome =
      sink.process(kWrite, {input("template", sheet), input("correspondences", pairs)});
  EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const cv::Mat picture = cv::imread((folder_ / "it.png").string());
  ASSERT_EQ(picture.size(), cv::Size(800, 400));
  const auto at = [&](int u, int v) { return picture.at<cv::Vec3b>(v, u); };
  EXPECT_GT(at(100, 100)[1], at(100, 100)[2] + 80) << "green: alone";
  EXPECT_GT(at(300, 100)[2], at(300, 100)[1] + 80) << "orange: has a twin";
  EXPECT_GT(at(340, 100)[2], at(340, 100)[0] + 80) << "the line to it";
  EXPECT_EQ(at(200, 100)[2], at(200, 100)[0]);
}

}  // namespace
