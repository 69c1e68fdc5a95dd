// SPDX-License-Identifier: Apache-2.0
#include "camera_images.hpp"

#include <algorithm>
#include <utility>
#include <weft/images/image_file.hpp>

#include "image_file.hpp"

namespace weft::images {
namespace {

/// The facts about the camera in the files that can be read.
std::vector<cameras::PhotoFacts> photo_facts(const std::vector<std::string>& paths) {
  std::vector<cameras::PhotoFacts> photos;
  for (const std::string& path : paths) {
    const auto file = read_image_bytes(path);
    if (!file) continue;
    cameras::PhotoFacts facts = cameras::facts_of(path, file->header);
    // For a format whose header is not read here.
    if (facts.size_px.empty()) facts.size_px = image_files::decode_upright(*file).pixels.size();
    if (!facts.size_px.empty()) photos.push_back(std::move(facts));
  }
  return photos;
}

/// An upright image in the middle of a canvas.
struct Photograph {
  image_files::Decoded image;  ///< image of the canvas
  cv::Mat inside;              ///< [H,W] u8, 255 in the image, 0 beyond; empty: it fills the canvas
};

Result<Photograph> read_photograph(const std::string& path, const cv::Size& canvas) {
  const auto file = read_image_bytes(path);
  if (!file) return file.error();
  auto decoded = of_8_bits(image_files::decode_upright(*file), path);
  if (!decoded) return decoded.error();
  const cv::Mat image = decoded->pixels;
  if (image.size() == canvas) return Photograph{*std::move(decoded), {}};
  const int right = canvas.width - image.cols, below = canvas.height - image.rows;
  if (right < 0 || below < 0) {
    return Error{Errc::invalid_data,
                 path + ": has become larger than all images were when the source was opened"};
  }
  const cv::Rect place(right / 2, below / 2, image.cols, image.rows);
  // A continued border is no edge, where black would be one.
  Photograph photograph{{{}, decoded->damage}, cv::Mat::zeros(canvas, CV_8U)};
  cv::copyMakeBorder(image, photograph.image.pixels, place.y, below - place.y, place.x,
                     right - place.x, cv::BORDER_REPLICATE);
  photograph.inside(place) = 255;
  return photograph;
}

}  // namespace

void CameraImages::declare(Params& p) {
  p.input_path("camera", camera_path_,
               "camera file: Weft's own (YAML or JSON), OpenCV's YAML or ROS camera_info; auto: "
               "assumed from EXIF and the image size",
               Need::required, {"auto"});
  cameras::declare(p, focal_);
  p.read("longest_px", longest_px_, "px", {0, 65'535},
         "maximum length of an image side; larger images are scaled down, with their camera; 0: no "
         "limit");
}

Result<void> CameraImages::read_camera(bool sizes_alone) {
  if (is_assumed()) return {};
  auto camera = sizes_alone ? cameras::CalibratedCamera::read_sizes(camera_path_)
                            : cameras::CalibratedCamera::read(camera_path_);
  if (!camera) return camera.error();
  camera_ = *std::move(camera);
  return {};
}

Result<void> CameraImages::fit(const std::vector<std::string>& paths) {
  if (!is_assumed()) {
    auto camera = camera_of_files(paths, camera_);
    if (!camera) return camera.error();
    camera_ = camera->at_most(longest_px_);
    return {};
  }
  const std::vector<cameras::PhotoFacts> photos = photo_facts(paths);
  const auto assumed = cameras::assume_camera(photos, focal_);
  if (!assumed) return assumed.error();
  has_canvas_ = std::any_of(photos.begin(), photos.end(), [&](const cameras::PhotoFacts& photo) {
    return photo.size_px != photos.front().size_px;
  });
  camera_ = cameras::CalibratedCamera::assumed(*assumed).at_most(longest_px_);
  return {};
}

void CameraImages::report(const Call& call, const std::string& images) const {
  camera_.report_orientation(call, images);
  if (is_assumed()) call.log_warning(cameras::assumption_text(camera_.pinhole()));
  if (!has_canvas_) return;
  const Camera& camera = camera_.pinhole();
  call.log_info("images have several sizes: each is in the middle of " +
                std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px) +
                " px, and what lies beyond it is outside of the region");
}

Result<CameraImages::Frame> CameraImages::read(const std::string& path,
                                               const std::string& stem) const {
  Photograph photograph;
  if (is_assumed()) {
    auto read = read_photograph(path, camera_.size_px());
    if (!read) return read.error();
    photograph = *std::move(read);
  } else {
    auto read = read_image_file(path, camera_);
    if (!read) return read.error();
    photograph.image = *std::move(read);
  }
  auto image = camera_.undistorted(photograph.image.pixels, path, stem);
  if (!image) return image.error();
  Frame frame{*std::move(image), {}, std::move(photograph.image.damage)};
  if (photograph.inside.empty()) return frame;
  auto inside = camera_.undistorted_mask(photograph.inside, path);
  if (!inside) return inside.error();
  frame.region = Region{*std::move(inside)};
  return frame;
}

}  // namespace weft::images
