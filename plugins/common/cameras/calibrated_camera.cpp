// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/calibrated_camera.hpp"

#include <algorithm>
#include <weft/images/image_file.hpp>

namespace weft::cameras {
namespace {

cv::Size size_of(const Camera& camera) {
  return {static_cast<int>(camera.width_px), static_cast<int>(camera.height_px)};
}

}  // namespace

Result<CalibratedCamera> CalibratedCamera::read(const std::string& path) {
  auto camera = read_sizes(path);
  if (camera) camera->undistorter_ = Undistorter(camera->file_);
  return camera;
}

Result<CalibratedCamera> CalibratedCamera::read_sizes(const std::string& path) {
  auto file = read_camera_file(path);
  if (!file) return file.error();
  CalibratedCamera camera;
  camera.path_ = path;
  camera.file_ = *std::move(file);
  camera.stored_.size_px = size_of(camera.file_.camera);
  return camera;
}

CalibratedCamera CalibratedCamera::guess(const cv::Size& size_px) {
  CalibratedCamera guessed;
  guessed.path_ = "the first frame";
  Camera& camera = guessed.file_.camera;
  camera.fx = camera.fy = std::max(size_px.width, size_px.height);
  camera.cx = 0.5 * (size_px.width - 1), camera.cy = 0.5 * (size_px.height - 1);
  camera.width_px = size_px.width, camera.height_px = size_px.height;
  guessed.stored_.size_px = size_px;
  return guessed;
}

Result<CalibratedCamera> CalibratedCamera::of_images(const StoredImages& stored,
                                                     const std::string& name) const {
  auto upright = upright_camera(file_, path_, stored, name);
  if (!upright) return upright.error();
  CalibratedCamera camera = *this;
  camera.stored_ = stored;
  if (!upright->is_rotated) return camera;
  camera.is_rotated_ = true;
  camera.file_ = upright->file;
  if (undistorter_.changes_images()) camera.undistorter_ = Undistorter(camera.file_);
  return camera;
}

Result<void> CalibratedCamera::check_size(const cv::Size& size_px, const std::string& name) const {
  const auto fits = upright_camera(file_, path_, {size_px, 1}, name);
  return fits ? Result<void>() : fits.error();
}

void CalibratedCamera::report_orientation(const Call& call, const std::string& images) const {
  if (stored_.orientation == 1) return;
  call.log_info(images + ": each " + orientation_text(stored_.orientation) + " to be upright" +
                (is_rotated_ ? ", and the camera with them"
                             : "; " + path_ + " has the size of the upright images"));
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

Result<image_files::Decoded> read_image_of(const std::string& path,
                                           const CalibratedCamera& camera) {
  const auto file = read_image_bytes(path);
  if (!file) return file.error();
  const ImageHeader& header = file->header;
  if (header.orientation != camera.stored().orientation) {
    return Error{Errc::invalid_data,
                 path + ": " + orientation_text(header.orientation) +
                     " to be upright, but the first image " +
                     orientation_text(camera.stored().orientation) +
                     ": all images of a source have one camera; read those of each orientation by "
                     "themselves, or save all upright"};
  }
  if (header.width_px > 0) {
    const cv::Size size(static_cast<int>(header.upright_width_px()),
                        static_cast<int>(header.upright_height_px()));
    if (auto fits = camera.check_size(size, path); !fits) return fits.error();
  }
  image_files::Decoded decoded = image_files::decode_upright(*file);
  if (decoded.pixels.empty()) return image_files::whole_pixels(decoded, path).error();
  return decoded;
}

Result<cv::Mat> read_image_beside(const std::string& path, const CalibratedCamera& camera) {
  const auto file = read_image_bytes(path);
  if (!file) return file.error();
  const ImageHeader& header = file->header;
  const StoredImages& frames = camera.stored();
  if (header.width_px > 0 && header.orientation == frames.orientation) {
    const cv::Size size(static_cast<int>(header.upright_width_px()),
                        static_cast<int>(header.upright_height_px()));
    if (auto fits = camera.check_size(size, path); !fits) return fits.error();
  }
  const auto stored = image_files::whole_pixels(image_files::decode_stored(*file), path);
  if (!stored) return stored;
  return image_files::upright_beside({"its frame", frames.size_px, frames.orientation}, *stored,
                                     header.orientation, path);
}

}  // namespace weft::cameras
