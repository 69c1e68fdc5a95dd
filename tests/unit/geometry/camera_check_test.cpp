// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <weft/geometry/camera_check.hpp>

namespace weft {
namespace {

const Camera kGood{528.0, 528.0, 320.0, 240.0, 640, 480};

/// The illegal field of a camera with one changed member.
template <class Member, class Value>
std::string illegal(Member member, Value value) {
  Camera camera = kGood;
  camera.*member = value;
  const auto mistake = camera_mistake(camera);
  return mistake ? mistake->field : "";
}

TEST(CameraCheck, AcceptsOrdinaryCamerasAndCutOutsOfTheirImages) {
  EXPECT_FALSE(camera_mistake(kGood));
  EXPECT_EQ(illegal(&Camera::cx, -640.0), "");
  EXPECT_EQ(illegal(&Camera::cx, 1280.0), "");
  EXPECT_EQ(illegal(&Camera::cy, 960.0), "");
  EXPECT_EQ(illegal(&Camera::fx, 5280.0), "");
  EXPECT_EQ(illegal(&Camera::width_px, 65535), "");
}

TEST(CameraCheck, NamesTheNumberThatNoCameraHas) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double focal_px : {0.0, -528.0, 1e9, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(illegal(&Camera::fx, focal_px), "fx") << focal_px;
    EXPECT_EQ(illegal(&Camera::fy, focal_px), "fy") << focal_px;
  }
  EXPECT_EQ(illegal(&Camera::fx, 5281.0), "fy");
  for (const double centre_px : {99999.0, -641.0, 1281.0, nan}) {
    EXPECT_EQ(illegal(&Camera::cx, centre_px), "cx") << centre_px;
  }
  EXPECT_EQ(illegal(&Camera::cy, 961.0), "cy");
  for (const std::int64_t size_px : {0, -1, 65536}) {
    EXPECT_EQ(illegal(&Camera::width_px, size_px), "width") << size_px;
    EXPECT_EQ(illegal(&Camera::height_px, size_px), "height") << size_px;
  }
}

TEST(CameraCheck, SaysTheLegalRange) {
  Camera camera = kGood;
  camera.cx = 99999;
  EXPECT_EQ(camera_mistake(camera)->message,
            "'cx' is 99999, legal is -640 to 1280 px: at most one width beyond the image");
}

}  // namespace
}  // namespace weft
