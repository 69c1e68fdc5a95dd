// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <weft/generators/marker_sheet.hpp>

namespace weft {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(MarkerSheet, KeepsMarkersSeparateAndInsideTheMargins) {
  for (const std::int64_t seed : {1, 2, 3, 99}) {
    MarkerSheetSpec spec;
    spec.seed = seed;
    const auto sheet = lay_out_markers(spec);
    ASSERT_TRUE(sheet) << seed << ": " << sheet.error().message;
    ASSERT_EQ(sheet->markers.size(), 100U);
    for (std::size_t i = 0; i < 100; ++i) {
      const SheetMarker& marker = sheet->markers[i];
      EXPECT_EQ(marker.id, static_cast<int>(i));
      EXPECT_GE(marker.corners_mm.minCoeff(), spec.margin_mm);
      EXPECT_LE(marker.corners_mm.col(0).maxCoeff(), 297 - spec.margin_mm);
      EXPECT_LE(marker.corners_mm.col(1).maxCoeff(), 210 - MarkerSheetSpec::kCaption_mm);
      for (std::size_t k = 0; k < i; ++k) {
        const Eigen::Vector2d offset_mm = marker.centre_mm() - sheet->markers[k].centre_mm();
        EXPECT_GE(offset_mm.cwiseAbs().maxCoeff(), spec.marker_mm + spec.gap_mm) << i << " " << k;
      }
    }
  }
}

TEST(MarkerSheet, DependsOnTheSeedAlone) {
  MarkerSheetSpec spec;
  const std::string first = to_yaml(*lay_out_markers(spec));
  EXPECT_EQ(first, to_yaml(*lay_out_markers(spec)));
  spec.seed = 2;
  EXPECT_NE(first, to_yaml(*lay_out_markers(spec)));
}

TEST(MarkerSheet, RefusesMarkersThatDoNotFit) {
  MarkerSheetSpec crowded, small;
  crowded.count = 180;
  small.width_mm = 20;
  for (const MarkerSheetSpec& spec : {crowded, small}) {
    const auto sheet = lay_out_markers(spec);
    ASSERT_FALSE(sheet);
    EXPECT_THAT(sheet.error().message, HasSubstr("do not fit"));
  }
}

TEST(MarkerSheet, IsWrittenWithItsCentresAndCorners) {
  Points2 corners(4, 2);
  corners << 10, 20, 24.125, 20, 24.125, 34, 10, 34;
  const std::string text = to_yaml({297.0, 210.0, "5x5_250", {{3, corners}}});
  EXPECT_THAT(text, StartsWith("#"));
  EXPECT_THAT(text, HasSubstr("marker_sheet: 1\ndictionary: 5x5_250\nwidth_mm: 297\n"
                              "height_mm: 210\nmarkers:\n"
                              "  - {id: 3, centre_mm: [17.063, 27], corners_mm: [[10, 20], "
                              "[24.125, 20], [24.125, 34], [10, 34]]}\n"));
}

}  // namespace
}  // namespace weft
