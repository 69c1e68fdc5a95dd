// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>
#include <weft/core/params.hpp>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/images/image_header.hpp>

namespace weft::cameras {

/// The focal length that is known without a calibration, such as the estimate of an earlier run.
struct KnownFocal {
  double by_side = 0.0;     ///< [] focal length divided by the longer side; 0: not known
  double by_side_sd = 0.0;  ///< [] its standard deviation
};

/// Declares `focal_by_side` and `focal_by_side_sd` of a source whose `camera` may be `auto`.
void declare(Params& p, KnownFocal& focal);

/// An error about `focal_by_side` where it is given beside another `camera` than `auto`, or is
/// missing beside its standard deviation.
Result<void> check(const KnownFocal& focal, bool is_assumed);

/// The facts that an image file has about a camera without a calibration.
struct PhotoFacts {
  std::string path;
  cv::Size size_px;       ///< upright
  int focal_35mm_mm = 0;  ///< [mm] EXIF FocalLengthIn35mmFilm; 0: not known
  cv::Size exif_px = {};  ///< EXIF PixelXDimension and PixelYDimension, upright; empty: not known
};
PhotoFacts facts_of(const std::string& path, const ImageHeader& header);

/// A pinhole for images of one camera, each in the middle of a canvas as large as the largest; the
/// principal point is in the middle, too. With f35 the 35 mm equivalent, which is by the diagonal,
///
///     f_px = f35 / 43.27 mm * diagonal of the whole image
///
/// An image whose sides have another ratio than 4:3, 3:2, 16:9 or 1:1 was cropped. The size of the
/// whole image is then read from EXIF or from the other images, or is assumed to be 4032 x 3024 px.
/// Without f35 the focal length is assumed to be the longer side. A `known` focal length replaces
/// both; the longer side is then that of the canvas. CameraAssumption of the camera has the
/// uncertainty of these values. Fails where the focal lengths differ by more than a tenth, and
/// without images.
Result<Camera> assume_camera(const std::vector<PhotoFacts>& photos, const KnownFocal& known = {});

/// The assumption in one sentence; empty for a camera that was calibrated.
std::string assumption_text(const Camera& camera);

}  // namespace weft::cameras
