// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/calibrated_camera.hpp"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <weft/core/image_file.hpp>

#include "common/images/picture_file.hpp"

namespace weft::cameras {
namespace {

std::string size_text(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height) + " px";
}

}  // namespace

Result<CalibratedCamera> CalibratedCamera::read(const std::string& path) {
  const auto file = read_camera_file(path);
  if (!file) return file.error();
  CalibratedCamera camera;
  camera.path_ = path;
  camera.camera_ = file->camera;
  camera.undistorter_ = Undistorter(*file);
  return camera;
}

Result<CalibratedCamera> CalibratedCamera::read_sizes(const std::string& path) {
  const auto file = read_camera_file(path);
  if (!file) return file.error();
  CalibratedCamera camera;
  camera.path_ = path;
  camera.camera_ = file->camera;
  return camera;
}

CalibratedCamera CalibratedCamera::guess(const cv::Size& size_px) {
  CameraFile file;
  Camera& camera = file.camera;
  camera.fx = camera.fy = std::max(size_px.width, size_px.height);
  camera.cx = 0.5 * (size_px.width - 1), camera.cy = 0.5 * (size_px.height - 1);
  camera.width_px = size_px.width, camera.height_px = size_px.height;
  CalibratedCamera guessed;
  guessed.path_ = "the first frame";
  guessed.camera_ = camera;
  guessed.undistorter_ = Undistorter(file);
  return guessed;
}

Result<void> CalibratedCamera::check_size(const cv::Size& size_px, const std::string& name) const {
  if (size_px.width == camera_.width_px && size_px.height == camera_.height_px) return {};
  return Error{Errc::invalid_data,
               name + ": is " + size_text(size_px.width, size_px.height) + ", but " + path_ +
                   " describes images of " + size_text(camera_.width_px, camera_.height_px) +
                   ": use the images that were calibrated, or correct the camera file"};
}

Result<Image> CalibratedCamera::undistorted(const cv::Mat& stored, const std::string& name,
                                            const std::string& stem) const {
  if (auto fits = check_size(stored.size(), name); !fits) return fits.error();
  const std::int64_t width = stored.cols, height = stored.rows;
  Image image;
  image.stem = stem;
  image.pixels = stored.channels() == 1 ? Array<std::uint8_t>({height, width})
                                        : Array<std::uint8_t>({height, width, 3});
  cv::Mat target(stored.size(), stored.type(), image.pixels.data());
  undistorter_.apply(stored, target);
  return image;
}

Result<Array<float>> CalibratedCamera::undistorted_depth(const cv::Mat& stored,
                                                         const std::string& name,
                                                         double unit_m) const {
  if (auto fits = check_size(stored.size(), name); !fits) return fits.error();
  Array<float> depth_m({std::int64_t{stored.rows}, std::int64_t{stored.cols}});
  cv::Mat target(stored.size(), CV_32F, depth_m.data());
  cv::Mat exact_m;  // OpenCV scales in the precision of the target
  undistorter_.nearest(stored).convertTo(exact_m, CV_64F, unit_m);
  exact_m.convertTo(target, CV_32F);
  return depth_m;
}

Result<Array<std::uint8_t>> CalibratedCamera::undistorted_mask(const cv::Mat& stored,
                                                               const std::string& name) const {
  if (auto fits = check_size(stored.size(), name); !fits) return fits.error();
  Array<std::uint8_t> mask({std::int64_t{stored.rows}, std::int64_t{stored.cols}});
  cv::Mat target(stored.size(), CV_8U, mask.data());
  cv::bitwise_and(undistorter_.nearest(stored != 0), cv::Scalar(1), target);
  return mask;
}

Result<cv::Mat> read_image_of(const std::string& path, const CalibratedCamera& camera) {
  const auto file = read_image_bytes(path);
  if (!file) return file.error();
  const ImageHeader& header = file->header;
  if (header.width_px > 0) {
    const cv::Size size(static_cast<int>(header.width_px), static_cast<int>(header.height_px));
    if (auto fits = camera.check_size(size, path); !fits) return fits.error();
  }
  cv::Mat image = image_files::decode_image(file->bytes, cv::IMREAD_UNCHANGED);
  if (image.empty()) return no_image(path);
  return image;
}

}  // namespace weft::cameras
