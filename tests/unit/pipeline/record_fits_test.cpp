// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <weft/testing/synthetic.hpp>

#include "pipeline/execution/checks.hpp"

namespace weft {
namespace {

TEST(CheckFits, TakesAShapeThatReachesBehindTheCameraForNoResult) {
  const auto sheet = host::Record::copy_of(testing::make_template({.columns = 3, .rows = 3}));
  const auto camera = host::Record::copy_of(testing::make_camera());
  Shape shape;
  shape.vertices_m = Array<double>({9, 3}, 0.5);
  shape.source = Array<std::uint8_t>({9}, 1);
  EXPECT_TRUE(check_fits(*host::Record::copy_of(shape), *sheet, *camera));
  for (const double z_m : {0.0, -0.25}) {
    shape.vertices_m(7, 2) = z_m;
    const auto fits = check_fits(*host::Record::copy_of(shape), *sheet, *camera);
    ASSERT_FALSE(fits);
    EXPECT_EQ(fits.error().code, Errc::no_result);
    EXPECT_EQ(fits.error().message, "the shape reaches behind the camera: its vertex 7 has Z = " +
                                        std::to_string(z_m) + " m");
  }
}

}  // namespace
}  // namespace weft
