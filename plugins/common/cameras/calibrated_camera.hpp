// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>
#include <weft/sdk/call.hpp>

#include "common/cameras/undistorter.hpp"
#include "common/cameras/upright_camera.hpp"
#include "common/images/decoder.hpp"

namespace weft::cameras {

/// A camera as its file describes it, and the mapping from its images to those of an ideal pinhole.
/// The pinhole has the same fx, fy, cx, cy and size. All other components see this pinhole.
class CalibratedCamera {
 public:
  /// Reads a camera file; see read_camera_file().
  static Result<CalibratedCamera> read(const std::string& path);

  /// The same without the maps of undistortion: to check a file and the sizes of its images.
  static Result<CalibratedCamera> read_sizes(const std::string& path);

  /// A camera without a calibration, for upright images; see common/assumed_cameras.
  static CalibratedCamera assumed(const Camera& camera);

  /// The same for stored images that are first made upright. Fails as upright_camera() does.
  Result<CalibratedCamera> of_images(const StoredImages& stored, const std::string& name) const;

  /// The same with images that are scaled down until no side is longer than this; 0 and images that
  /// are small enough leave it as it is. Sides are rounded to whole pixels, and focal lengths and
  /// principal point follow each side exactly.
  CalibratedCamera at_most(int longest_px) const;

  /// The camera of the images that it returns: upright, scaled and without distortion.
  const Camera& pinhole() const { return pinhole_.camera; }
  /// The size of upright images as they are passed in.
  cv::Size size_px() const;
  bool scales() const;
  const StoredImages& stored() const { return stored_; }
  /// True if upright images have another frame than the file describes.
  bool is_rotated() const { return is_rotated_; }
  /// Logs how `images` are made upright, and what that means for the camera; nothing where they are
  /// stored so.
  void report_orientation(const Call& call, const std::string& images) const;

  /// An error unless upright images of this size are the camera's; `name` is the image's in the
  /// message.
  Result<void> check_size(const cv::Size& size_px, const std::string& name) const;

  /// An upright image of the camera, 8 bits a channel and grey or BGR, scaled (each pixel is the
  /// mean of those that it covers) and without its distortion. Fails as check_size() does.
  Result<Image> undistorted(const cv::Mat& stored, const std::string& name,
                            const std::string& stem) const;

  /// A depth image of the camera (16 bits, one channel) in metres [H,W], scaled and without its
  /// distortion; each pixel has one measured depth, the nearest, or 0. Fails as check_size() does.
  Result<Array<float>> undistorted_depth(const cv::Mat& stored, const std::string& name,
                                         double unit_m) const;

  /// A mask of the camera (one channel) as 0 and 1 [H,W], scaled and without its distortion. It is
  /// 1 where the nearest stored pixel is not 0, and 0 outside the camera's field of view. Fails as
  /// check_size() does.
  Result<Array<std::uint8_t>> undistorted_mask(const cv::Mat& stored,
                                               const std::string& name) const;

 private:
  void set_file(CameraFile file);
  cv::Mat nearest(const cv::Mat& stored) const;

  std::string path_;
  CameraFile file_;     ///< for upright images as they are passed in
  CameraFile pinhole_;  ///< the same of scaled ones
  StoredImages stored_;
  bool is_rotated_ = false;
  Undistorter undistorter_;
};

/// An image of the camera, made upright, and what is damaged in it. Its header is read before its
/// pixels are decoded, so that an image of another size or orientation costs nothing. Fails with a
/// message that names the file.
Result<image_files::Decoded> read_image_of(const std::string& path, const CalibratedCamera& camera);

/// An image that belongs to a frame of the camera pixel by pixel, upright as that; see
/// image_files::upright_beside().
Result<cv::Mat> read_image_beside(const std::string& path, const CalibratedCamera& camera);

}  // namespace weft::cameras
