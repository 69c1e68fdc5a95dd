// SPDX-License-Identifier: Apache-2.0
// The page on which corners are moved; tests/integration/corner_page opens it.
#include "corner_page.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "photo_folder.hpp"

namespace weft::photo {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::PluginAnswer;

/// A template of the folder's photo.png, and its page.
struct PageOfPhoto {
  PluginAnswer answer;
  std::string text;
};

PageOfPhoto page_of(PhotoFolder& folder, const std::string& more) {
  const std::string path = folder.path("corners.html");
  PageOfPhoto page;
  page.answer = folder.build(", width_m: 0.297, corners_page: '" + path + "'" + more);
  std::ifstream file(path, std::ios::binary);
  page.text.assign(std::istreambuf_iterator<char>(file), {});
  return page;
}

/// Where the rings of a page stand.
Corners rings_of(const std::string& page) {
  std::array<double, 8> p{};
  const std::size_t at = page.find("\"corners_px\": [[");
  if (at == std::string::npos) throw std::runtime_error("the page has no corners");
  EXPECT_EQ(std::sscanf(page.c_str() + at,
                        "\"corners_px\": [[%lf, %lf], [%lf, %lf], [%lf, %lf], [%lf, %lf]]", &p[0],
                        &p[1], &p[2], &p[3], &p[4], &p[5], &p[6], &p[7]),
            8);
  return {Eigen::Vector2d(p[0], p[1]), {p[2], p[3]}, {p[4], p[5]}, {p[6], p[7]}};
}

TEST(CornerPage, ShowsThePhotographWithRingsWhereItsCornersWereFound) {
  PhotoFolder folder;
  Still still = still_of(960, true);
  still.tilt_rad = 0.3;
  folder.take(still);
  const PageOfPhoto page = page_of(folder, folder.with_camera());
  ASSERT_EQ(page.answer.status, WEFT_OK) << page.answer.message;
  EXPECT_TRUE(page.text.starts_with("<!DOCTYPE html>"));
  EXPECT_THAT(page.text, AllOf(HasSubstr("\"width_px\": 960, \"height_px\": 720, "),
                               HasSubstr("\"data:image/jpeg;base64,/9j/"), Not(HasSubstr("WEFT_")),
                               Not(HasSubstr("://"))));
  const Corners rings = rings_of(page.text), truth = true_corners_seen(still);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((rings[k] - truth[k]).norm(), 0.6) << k;
}

TEST(CornerPage, ShowsCornersThatAreGivenWhereTheyAreInThePhotograph) {
  PhotoFolder folder;
  folder.take(still_of(640, true));
  const PageOfPhoto page = page_of(
      folder, folder.with_camera() + ", corners: [130.5, 110, 500, 120.25, 510, 370, 120, 380]");
  EXPECT_NE(page.answer.status, WEFT_ERROR) << page.answer.message;
  const Corners rings = rings_of(page.text);
  const Corners given{
      Eigen::Vector2d(130.5, 110.0), {500.0, 120.25}, {510.0, 370.0}, {120.0, 380.0}};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((rings[k] - given[k]).norm(), 0.02) << k;
}

TEST(CornerPage, IsWrittenWhereThereAreNoCornersAndWhereTheyAreOfNoUse) {
  PhotoFolder folder;
  folder.files().write_image("photo.png", cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(120)));
  for (const char* more : {"", ", corners: [10, 10, 400, 12, 200, 200, 10, 200]"}) {
    const PageOfPhoto page = page_of(folder, more);
    EXPECT_EQ(page.answer.status, WEFT_ERROR);
    EXPECT_THAT(page.text, HasSubstr("\"height_px\": 240, \"corners_px\": null, ")) << more;
  }
  const PageOfPhoto oblique = page_of(folder, ", corners: [120, 100, 200, 100, 310, 140, 5, 140]");
  EXPECT_THAT(oblique.answer.message, HasSubstr("too obliquely"));
  EXPECT_EQ(rings_of(oblique.text)[2].x(), 310.0);
}

TEST(CornerPage, ThatCannotBeWrittenIsAnErrorThatNamesIt) {
  PhotoFolder folder;
  folder.files().write_image("photo.png", cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(120)));
  const std::string path = folder.path("none/corners.html");
  const PluginAnswer answer = folder.build(", width_m: 0.3, corners_page: '" + path + "'");
  EXPECT_EQ(answer.status, WEFT_ERROR);
  EXPECT_EQ(answer.where, path);
  EXPECT_THAT(answer.message, HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace weft::photo
