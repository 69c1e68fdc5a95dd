// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <weft/core/result.hpp>
#include <weft/generators/marker_sheet.hpp>

namespace weft::frex_sheet {

/// The marker sheet of paper as it is printed, grey u8. Pixel (u,v) is the mean over [u, u+1] x [v,
/// v+1] / px_per_mm of black markers on white paper. Fails on ids that the dictionary of the layout
/// does not have.
Result<cv::Mat> draw_sheet(const MarkerSheet& sheet, int px_per_mm);

}  // namespace weft::frex_sheet
