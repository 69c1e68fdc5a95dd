// SPDX-License-Identifier: Apache-2.0
#include "photograph.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <weft/core/stop_check.hpp>
#include <weft/images/image_file.hpp>

#include "common/cameras/upright_camera.hpp"
#include "common/images/picture_file.hpp"

namespace weft::photo {
namespace {

constexpr int kLeastPhoto_px = 64, kMostPhoto_px = 32766;  // OpenCV's remapping counts in 16 bits
constexpr double kGuessedFocal = 0.8;

std::string size_text(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height) + " px";
}

/// For a photograph of `size` and the camera of the parameter.
Error other_size(const std::string& path, const std::string& camera_path, const Camera& camera,
                 const cv::Size& size) {
  const bool is_turned = size.width == camera.height_px && size.height == camera.width_px;
  return {Errc::invalid_data,
          path + ": is " + size_text(size.width, size.height) + ", but " + camera_path +
              " describes images of " + size_text(camera.width_px, camera.height_px) +
              (is_turned ? ": take it with the camera held as for the calibration, or correct "
                           "'camera'"
                         : ": take it with the resolution that was calibrated, correct 'camera', "
                           "or leave it out"),
          {}};
}

Camera guessed_camera(const cv::Size& size) {
  Camera camera;
  camera.width_px = size.width;
  camera.height_px = size.height;
  camera.fx = camera.fy = kGuessedFocal * std::max(size.width, size.height);
  camera.cx = 0.5 * (size.width - 1);
  camera.cy = 0.5 * (size.height - 1);
  return camera;
}

}  // namespace

Result<Photograph> read_photograph(const std::string& path, const std::string& camera_path) {
  if (auto legal = image_files::check_picture("photo", path); !legal) return legal.error();
  const auto file = read_image_bytes(path);
  if (!file) return image_files::at_parameter(file.error(), "photo");
  ask_to_go_on();
  const auto pixels = image_files::whole_pixels(image_files::decode_upright(*file), path);
  if (!pixels) return image_files::at_parameter(pixels.error(), "photo");
  Photograph photo{*pixels};
  if (pixels->channels() == 2) cv::extractChannel(*pixels, photo.pixels, 0);
  if (pixels->channels() == 4) cv::cvtColor(*pixels, photo.pixels, cv::COLOR_BGRA2BGR);
  photo.orientation = file->header.orientation;
  const cv::Size size = photo.pixels.size();
  if (std::min(size.width, size.height) < kLeastPhoto_px ||
      std::max(size.width, size.height) > kMostPhoto_px) {
    return Error{Errc::invalid_data, path + ": a photograph has sides of " +
                                         std::to_string(kLeastPhoto_px) + " to " +
                                         std::to_string(kMostPhoto_px) + " px, not " +
                                         size_text(size.width, size.height) + ": correct 'photo'"};
  }
  if (camera_path.empty()) {
    photo.camera.camera = guessed_camera(size);
    return photo;
  }
  auto camera = cameras::read_camera_file(camera_path);
  if (!camera) return camera.error();
  photo.camera = *std::move(camera);
  photo.is_calibrated = true;
  const Camera& described = photo.camera.camera;
  const bool fits = size.width == described.width_px && size.height == described.height_px;
  if (photo.orientation == 1 && !fits) return other_size(path, camera_path, described, size);
  const cv::Size stored =
      turns(photo.orientation).sideways ? cv::Size(size.height, size.width) : size;
  auto upright =
      cameras::upright_camera(photo.camera, camera_path, {stored, photo.orientation}, path);
  if (!upright) return upright.error();
  photo.camera = std::move(upright->file);
  return photo;
}

cv::Mat lab_of(const cv::Mat& pixels) {
  cv::Mat bgr = pixels, lab;
  if (pixels.channels() == 1) cv::cvtColor(pixels, bgr, cv::COLOR_GRAY2BGR);
  cv::cvtColor(bgr, lab, cv::COLOR_BGR2Lab);
  return lab;
}

}  // namespace weft::photo
