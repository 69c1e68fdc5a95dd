// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/calibrated_camera.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
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
  camera.set_file(*std::move(file));
  camera.stored_.size_px = camera.size_px();
  return camera;
}

CalibratedCamera CalibratedCamera::assumed(const Camera& camera) {
  CalibratedCamera made;
  made.path_ = "the first frame";
  made.set_file({camera, Distortion::none, {}});
  made.stored_.size_px = made.size_px();
  return made;
}

Result<CalibratedCamera> CalibratedCamera::of_images(const StoredImages& stored,
                                                     const std::string& name) const {
  auto upright = upright_camera(file_, path_, stored, name);
  if (!upright) return upright.error();
  CalibratedCamera camera = *this;
  camera.stored_ = stored;
  if (!upright->is_rotated) return camera;
  camera.is_rotated_ = true;
  camera.set_file(upright->file);
  return camera;
}

CalibratedCamera CalibratedCamera::at_most(int longest_px) const {
  const cv::Size size = size_px();
  const int longer = std::max(size.width, size.height);
  CalibratedCamera camera = *this;
  if (longest_px == 0 || longer <= longest_px) return camera;
  const auto scaled = [&](int side) {
    const double exact = static_cast<double>(side) * longest_px / longer;
    return std::max(1, static_cast<int>(std::lround(exact)));
  };
  const cv::Size target(scaled(size.width), scaled(size.height));
  const double by_x = static_cast<double>(target.width) / size.width;
  const double by_y = static_cast<double>(target.height) / size.height;
  Camera& pinhole = camera.pinhole_.camera;
  pinhole.fx *= by_x, pinhole.fy *= by_y;
  // Pixel centres are whole numbers, so that the image begins at -0.5 px before and after.
  pinhole.cx = (pinhole.cx + 0.5) * by_x - 0.5;
  pinhole.cy = (pinhole.cy + 0.5) * by_y - 0.5;
  pinhole.width_px = target.width, pinhole.height_px = target.height;
  if (auto assumption = CameraAssumption::of(pinhole)) {
    assumption->focal_sd_px *= by_x;
    assumption->cx_sd_px *= by_x, assumption->cy_sd_px *= by_y;
    assumption->add_to(pinhole);
  }
  if (undistorter_.changes_images()) camera.undistorter_ = Undistorter(camera.pinhole_);
  return camera;
}

void CalibratedCamera::set_file(CameraFile file) {
  file_ = std::move(file);
  pinhole_ = file_;
  if (undistorter_.changes_images()) undistorter_ = Undistorter(file_);
}

cv::Size CalibratedCamera::size_px() const { return size_of(file_.camera); }

bool CalibratedCamera::scales() const { return size_of(pinhole_.camera) != size_px(); }

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
  const std::int64_t width = pinhole().width_px, height = pinhole().height_px;
  Image image;
  image.stem = stem;
  image.pixels = stored.channels() == 1 ? Array<std::uint8_t>({height, width})
                                        : Array<std::uint8_t>({height, width, 3});
  cv::Mat target(size_of(pinhole()), stored.type(), image.pixels.data());
  if (!scales()) {
    undistorter_.apply(stored, target);
  } else if (!undistorter_.changes_images()) {
    cv::resize(stored, target, target.size(), 0.0, 0.0, cv::INTER_AREA);
  } else {
    cv::Mat scaled;
    cv::resize(stored, scaled, target.size(), 0.0, 0.0, cv::INTER_AREA);
    undistorter_.apply(scaled, target);
  }
  return image;
}

cv::Mat CalibratedCamera::nearest(const cv::Mat& stored) const {
  if (!scales()) return undistorter_.nearest(stored);
  cv::Mat scaled;
  cv::resize(stored, scaled, size_of(pinhole()), 0.0, 0.0, cv::INTER_NEAREST_EXACT);
  return undistorter_.nearest(scaled);
}

Result<Array<float>> CalibratedCamera::undistorted_depth(const cv::Mat& stored,
                                                         const std::string& name,
                                                         double unit_m) const {
  if (auto fits = check_size(stored.size(), name); !fits) return fits.error();
  Array<float> depth_m({pinhole().height_px, pinhole().width_px});
  cv::Mat target(size_of(pinhole()), CV_32F, depth_m.data());
  cv::Mat exact_m;  // OpenCV scales in the precision of the target
  nearest(stored).convertTo(exact_m, CV_64F, unit_m);
  exact_m.convertTo(target, CV_32F);
  return depth_m;
}

Result<Array<std::uint8_t>> CalibratedCamera::undistorted_mask(const cv::Mat& stored,
                                                               const std::string& name) const {
  if (auto fits = check_size(stored.size(), name); !fits) return fits.error();
  Array<std::uint8_t> mask({pinhole().height_px, pinhole().width_px});
  cv::Mat target(size_of(pinhole()), CV_8U, mask.data());
  cv::bitwise_and(nearest(stored != 0), cv::Scalar(1), target);
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
