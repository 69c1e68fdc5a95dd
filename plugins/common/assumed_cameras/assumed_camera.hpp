// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/images/image_header.hpp>

namespace weft::cameras {

/// What an image says of a camera without a calibration.
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
/// whole image is then what EXIF or another of the images says, or is assumed to be 4032 x 3024 px.
/// Without f35 the focal length is assumed to be the longer side. How uncertain these are goes with
/// the camera, see CameraAssumption. Fails where the focal lengths differ by more than a tenth, and
/// without images.
Result<Camera> assume_camera(const std::vector<PhotoFacts>& photos);

/// What was assumed, in one sentence; empty for a camera that was calibrated.
std::string assumption_text(const Camera& camera);

}  // namespace weft::cameras
