// SPDX-License-Identifier: Apache-2.0
#include "common/assumed_cameras/assumed_camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

namespace weft::cameras {
namespace {

// Relative standard deviations of the focal length.
constexpr double kOfExif = 0.05;     // f35 is a whole number, and focusing changes the view
constexpr double kOfTrimmed = 0.10;  // 16:9 and 1:1 are made of 4:3 by phones, with the same f35
constexpr double kOfUnknown = 0.20;  // relative uncertainty of a crop: phones write images of 8 to
                                     // 50 megapixels
constexpr double kOfNothing = 0.25;  // phones 0.75, webcams 0.9, cameras up to 1.4 longer sides
constexpr double kOfCentre = 0.01;   // uncertainty of the principal point, in longer sides
constexpr double kMostFocalRatio = 1.1;  // ratio of focal lengths that are still one camera
constexpr double kFilm_mm = 43.27;       // diagonal of 36 x 24 mm
const cv::Size kUsual_px(4032, 3024);    // the usual image of a phone, 12 megapixels

double ratio_of(const cv::Size& size) {
  return static_cast<double>(std::max(size.width, size.height)) /
         std::max(1, std::min(size.width, size.height));
}

/// Sensors are a few pixels off their nominal ratio, up to 0.7 %.
bool is_near(double ratio, double other, double tolerance = 0.007) {
  return std::abs(ratio / other - 1.0) < tolerance;
}

double diagonal_px(const cv::Size& size) { return std::hypot(size.width, size.height); }

/// The size with its longer side where that of `other` is.
cv::Size turned_as(const cv::Size& size, const cv::Size& other) {
  const bool turns = (size.width > size.height) != (other.width > other.height);
  return turns ? cv::Size(size.height, size.width) : size;
}

/// 4032 x 3024 px, turned as the image is, and larger where the image is.
cv::Size usual_whole(const cv::Size& part) {
  const int longer = std::max(part.width, part.height), shorter = std::min(part.width, part.height);
  const int side = std::max({kUsual_px.width, longer, (shorter * 4 + 2) / 3});
  return turned_as({side, side * 3 / 4}, part);
}

/// An uncropped image that may contain other images: its size and the source of that size.
struct Whole {
  cv::Size size_px;
  double relative_sd;  ///< uncertainty of a focal length from its diagonal
  const char* from;    ///< source of its size
};

bool is_sensor(double ratio) { return is_near(ratio, 4.0 / 3.0) || is_near(ratio, 1.5); }
bool is_trimmed(double ratio) { return is_near(ratio, 16.0 / 9.0) || is_near(ratio, 1.0); }

/// The size in the EXIF data of an image that is cropped, where these have kept the original size.
std::optional<Whole> whole_in_exif(const PhotoFacts& photo) {
  const double ratio = ratio_of(photo.exif_px);
  const bool fits =
      photo.exif_px.width >= photo.size_px.width && photo.exif_px.height >= photo.size_px.height;
  const bool is_whole = is_sensor(ratio) || is_trimmed(ratio);
  if (!fits || !is_whole || is_near(ratio_of(photo.size_px), ratio)) return std::nullopt;
  return Whole{photo.exif_px, kOfExif, "by EXIF"};
}

/// An image with the sides of a sensor, if it is no part.
std::optional<Whole> whole_by_sides(const PhotoFacts& photo) {
  const double ratio = ratio_of(photo.size_px);
  if (is_sensor(ratio)) return Whole{photo.size_px, kOfExif, "by another image"};
  if (is_trimmed(ratio)) return Whole{photo.size_px, kOfTrimmed, "by another image"};
  return std::nullopt;
}

/// True if a part, turned or not, is not larger than this.
bool contains(const cv::Size& whole, const cv::Size& part) {
  return std::max(part.width, part.height) <= std::max(whole.width, whole.height) &&
         std::min(part.width, part.height) <= std::min(whole.width, whole.height);
}

/// The largest whole image of those with a focal length. Among images that were cropped by hand one
/// may have the sides of a sensor by chance: it is none if another one is larger.
std::optional<Whole> largest_whole(const std::vector<PhotoFacts>& photos) {
  std::optional<Whole> largest;
  for (const PhotoFacts& photo : photos) {
    auto own = whole_in_exif(photo);
    if (!own) own = whole_by_sides(photo);
    if (photo.focal_35mm_mm <= 0 || !own) continue;
    if (!largest || diagonal_px(own->size_px) > diagonal_px(largest->size_px)) largest = own;
  }
  const auto fits = [&](const PhotoFacts& photo) {
    return photo.focal_35mm_mm <= 0 || contains(largest->size_px, photo.size_px);
  };
  return largest && std::all_of(photos.begin(), photos.end(), fits) ? largest : std::nullopt;
}

/// The uncropped image that contains an image, or is the image itself; nothing where that is
/// unknown.
std::optional<Whole> whole_of(const PhotoFacts& photo, const std::optional<Whole>& largest) {
  if (auto own = whole_in_exif(photo)) return own;
  const auto own = whole_by_sides(photo);
  if (!own || !largest) return largest;
  // The same sides to a pixel: the same image, scaled.
  const double ratio = ratio_of(photo.size_px), other = ratio_of(largest->size_px);
  return is_near(ratio, other, 1.5 / std::min(photo.size_px.width, photo.size_px.height)) ? own
                                                                                          : largest;
}

struct Focal {
  double f_px, relative_sd;
  std::string from;
};

std::string name_of(const PhotoFacts& photo) {
  return std::filesystem::path(photo.path).filename().string();
}

Focal focal_of(const PhotoFacts& photo, const std::optional<Whole>& largest) {
  const Whole whole = whole_of(photo, largest)
                          .value_or(Whole{usual_whole(photo.size_px), kOfUnknown,
                                          "by assumption, since EXIF lacks the size"});
  std::string from =
      fmt::format("{} mm in terms of 35 mm film, EXIF of {}", photo.focal_35mm_mm, name_of(photo));
  if (whole.size_px != photo.size_px) {
    from += fmt::format(", which is cropped from {} x {} px {}", whole.size_px.width,
                        whole.size_px.height, whole.from);
  }
  return {photo.focal_35mm_mm / kFilm_mm * diagonal_px(whole.size_px), whole.relative_sd, from};
}

Result<Focal> common_focal(const std::vector<PhotoFacts>& photos,
                           const std::optional<Whole>& largest, double longer_side_px,
                           const KnownFocal& known) {
  if (known.by_side > 0.0) {
    const double relative_sd = known.by_side_sd > 0.0 ? known.by_side_sd / known.by_side : kOfExif;
    return Focal{known.by_side * longer_side_px, relative_sd,
                 fmt::format("'focal_by_side' {}", known.by_side)};
  }
  std::optional<Focal> first;
  const PhotoFacts* of_first = nullptr;
  for (const PhotoFacts& photo : photos) {
    if (photo.focal_35mm_mm <= 0) continue;
    Focal focal = focal_of(photo, largest);
    if (!first) {
      first = std::move(focal), of_first = &photo;
      continue;
    }
    const double ratio = std::max(focal.f_px / first->f_px, first->f_px / focal.f_px);
    if (ratio > kMostFocalRatio) {
      return Error{
          Errc::invalid_data,
          fmt::format("{}: its EXIF states a focal length of {:.0f} px, but that of {} states "
                      "{:.0f} px. All images of a source have one camera: read those of each "
                      "camera, zoom and scale separately, or give a camera file",
                      photo.path, focal.f_px, name_of(*of_first), first->f_px)};
    }
    first->relative_sd = std::max(first->relative_sd, focal.relative_sd);
  }
  if (first) return *first;
  return Focal{longer_side_px, kOfNothing,
               "the longer side, since there is no focal length in EXIF"};
}

}  // namespace

PhotoFacts facts_of(const std::string& path, const ImageHeader& header) {
  const bool sideways = turns(header.orientation).sideways;
  const auto width = static_cast<int>(header.exif_width_px),
             height = static_cast<int>(header.exif_height_px);
  return {
      path,
      {static_cast<int>(header.upright_width_px()), static_cast<int>(header.upright_height_px())},
      header.focal_35mm_mm,
      sideways ? cv::Size(height, width) : cv::Size(width, height)};
}

void declare(Params& p, KnownFocal& focal) {
  p.read("focal_by_side", focal.by_side, "", {0.0, 100.0},
         "focal length divided by the longer side of the image, for camera: auto; 0: from EXIF, "
         "else 1");
  p.read("focal_by_side_sd", focal.by_side_sd, "", {0.0, 100.0},
         "standard deviation of focal_by_side; 0: 5 % of it");
}

Result<void> check(const KnownFocal& focal, bool is_assumed) {
  if (focal.by_side > 0.0 && !is_assumed) {
    return Error{
        Errc::invalid_value, "needs camera: auto; a camera file already has a focal length", {}};
  }
  if (focal.by_side_sd > 0.0 && !(focal.by_side > 0.0)) {
    return Error{Errc::invalid_value, "must be given where focal_by_side_sd is", {}};
  }
  return {};
}

Result<Camera> assume_camera(const std::vector<PhotoFacts>& photos, const KnownFocal& known) {
  if (photos.empty()) return Error{Errc::invalid_data, "there is no image to assume a camera from"};
  cv::Size canvas;
  for (const PhotoFacts& photo : photos) {
    canvas.width = std::max(canvas.width, photo.size_px.width);
    canvas.height = std::max(canvas.height, photo.size_px.height);
  }
  const double longer_side_px = std::max(canvas.width, canvas.height);
  const std::optional<Whole> largest = largest_whole(photos);
  const auto focal = common_focal(photos, largest, longer_side_px, known);
  if (!focal) return focal.error();
  // A part may lie anywhere in its whole.
  double sum_x = 0.0, sum_y = 0.0;
  for (const PhotoFacts& photo : photos) {
    const std::optional<Whole> part_of = whole_of(photo, largest);
    const bool fits = part_of && part_of->size_px.width >= photo.size_px.width &&
                      part_of->size_px.height >= photo.size_px.height;
    const cv::Size whole = fits                      ? part_of->size_px
                           : part_of                 ? turned_as(part_of->size_px, photo.size_px)
                           : photo.focal_35mm_mm > 0 ? usual_whole(photo.size_px)
                                                     : canvas;
    sum_x += std::pow(std::max(0, whole.width - photo.size_px.width), 2);
    sum_y += std::pow(std::max(0, whole.height - photo.size_px.height), 2);
  }
  const double least = std::pow(kOfCentre * longer_side_px, 2);
  const double parts = 12.0 * static_cast<double>(photos.size());
  Camera camera;
  camera.fx = camera.fy = focal->f_px;
  camera.cx = 0.5 * (canvas.width - 1), camera.cy = 0.5 * (canvas.height - 1);
  camera.width_px = canvas.width, camera.height_px = canvas.height;
  CameraAssumption{focal->relative_sd * focal->f_px, std::sqrt(least + sum_x / parts),
                   std::sqrt(least + sum_y / parts), focal->from}
      .add_to(camera);
  return camera;
}

std::string assumption_text(const Camera& camera) {
  const auto assumed = CameraAssumption::of(camera);
  if (!assumed) return {};
  return fmt::format(
      "not calibrated: the focal length is assumed to be {:.0f} px with a standard deviation of "
      "{:.0f} px ({}). The principal point is assumed to be the middle, ({:.1f}, {:.1f}) px, with "
      "({:.0f}, {:.0f}) px. Depths are as uncertain as the focal length: make a camera file with "
      "`weft calibrate`",
      camera.fx, assumed->focal_sd_px, assumed->from, camera.cx, camera.cy, assumed->cx_sd_px,
      assumed->cy_sd_px);
}

}  // namespace weft::cameras
