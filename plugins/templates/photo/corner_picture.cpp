// SPDX-License-Identifier: Apache-2.0
#include "corner_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <vector>
#include <weft/core/stop_check.hpp>
#include <weft/core/whole_file.hpp>

#include "rectified.hpp"

namespace weft::photo {
namespace {

constexpr double kLargest_px = 1600.0;
constexpr int kShift = 4;  // positions are given to OpenCV in 1/16 px
const cv::Scalar kMeshColour(97, 222, 64), kCornerColour(0, 110, 255);  // BGR, as in other images

/// A smaller photograph to draw on, by places of the unit square.
class Canvas {
 public:
  Canvas(const Photograph& photo, const Eigen::Matrix3d& ideal_from_unit)
      : photo_(photo), ideal_from_unit_(ideal_from_unit) {
    const cv::Size size = photo.pixels.size();
    scale_ = std::min(1.0, kLargest_px / std::max(size.width, size.height));
    cv::resize(photo.pixels, picture_, {}, scale_, scale_, cv::INTER_AREA);
    if (picture_.channels() == 1) cv::cvtColor(picture_, picture_, cv::COLOR_GRAY2BGR);
  }

  /// A side of the surface or of the mesh, which a lens may bend, over a dark halo.
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int width) {
    constexpr int kPieces = 24;
    std::vector<cv::Point> points;
    for (int i = 0; i <= kPieces; ++i) {
      const Eigen::Vector2d unit = from + (to - from) * i / kPieces;
      points.push_back(fixed(seen(unit)));
    }
    cv::polylines(picture_, points, false, cv::Scalar::all(0), width + 2, cv::LINE_AA, kShift);
    cv::polylines(picture_, points, false, kMeshColour, width, cv::LINE_AA, kShift);
  }

  /// A ring around a corner, its number and its place in the photograph, towards the middle.
  void corner(int number, const Eigen::Vector2d& unit) {
    constexpr int kRadius_px = 9;
    const Eigen::Vector2d at = seen(unit);
    cv::circle(picture_, fixed(at), kRadius_px << kShift, cv::Scalar::all(0), 4, cv::LINE_AA,
               kShift);
    cv::circle(picture_, fixed(at), kRadius_px << kShift, kCornerColour, 2, cv::LINE_AA, kShift);
    const Eigen::Vector2d in_photo = photo_.seen_at(ideal_px(ideal_from_unit_, unit.x(), unit.y()));
    const std::string words =
        std::to_string(number) + ": " + tenths(in_photo.x()) + ", " + tenths(in_photo.y());
    text(words,
         at + Eigen::Vector2d(unit.x() > 0.5 ? -170.0 : 14.0, unit.y() > 0.5 ? -16.0 : 28.0));
  }

  void text(const std::string& words, const Eigen::Vector2d& at) {
    const cv::Point place(static_cast<int>(at.x()), static_cast<int>(at.y()));
    const auto put = [&](const cv::Scalar& colour, int width) {
      cv::putText(picture_, words, place, cv::FONT_HERSHEY_SIMPLEX, 0.6, colour, width,
                  cv::LINE_AA);
    };
    put(cv::Scalar::all(0), 4);
    put(cv::Scalar::all(255), 1);
  }

  const cv::Mat& picture() const { return picture_; }

 private:
  static std::string tenths(double value) {
    const std::string digits = std::to_string(std::round(10.0 * value) / 10.0);
    return digits.substr(0, digits.find('.') + 2);
  }
  Eigen::Vector2d seen(const Eigen::Vector2d& unit) const {
    const Eigen::Vector2d at = photo_.seen_at(ideal_px(ideal_from_unit_, unit.x(), unit.y()));
    return scale_ * (at.array() + 0.5) - 0.5;
  }
  static cv::Point fixed(const Eigen::Vector2d& at) {
    const auto coordinate = [](double px) {
      return static_cast<int>(std::lround(std::clamp(px, -1e5, 1e5) * (1 << kShift)));
    };
    return {coordinate(at.x()), coordinate(at.y())};
  }

  const Photograph& photo_;
  Eigen::Matrix3d ideal_from_unit_;
  double scale_ = 1.0;
  cv::Mat picture_;
};

cv::Mat draw_corners(const Photograph& photo, const Findings& findings) {
  Canvas canvas(photo, findings.ideal_from_unit);
  for (int i = 0; i < findings.columns; ++i) {
    worked(1000);
    const double u = static_cast<double>(i) / (findings.columns - 1);
    canvas.line({u, 0.0}, {u, 1.0}, i == 0 || i + 1 == findings.columns ? 2 : 1);
  }
  for (int j = 0; j < findings.rows; ++j) {
    worked(1000);
    const double v = static_cast<double>(j) / (findings.rows - 1);
    canvas.line({0.0, v}, {1.0, v}, j == 0 || j + 1 == findings.rows ? 2 : 1);
  }
  canvas.corner(1, {0.0, 0.0});
  canvas.corner(2, {1.0, 0.0});
  canvas.corner(3, {1.0, 1.0});
  canvas.corner(4, {0.0, 1.0});
  canvas.text(findings.size + (photo.is_calibrated ? "" : ", NOT CALIBRATED"), {12.0, 24.0});
  return canvas.picture();
}

}  // namespace

Result<void> write_corner_picture(const Photograph& photo, const Findings& findings,
                                  const std::string& path) {
  std::vector<std::uint8_t> png;
  if (!cv::imencode(".png", draw_corners(photo, findings), png)) {
    return Error{Errc::unsupported, "the image is too large for PNG", path};
  }
  return write_whole({reinterpret_cast<const char*>(png.data()), png.size()}, path);
}

}  // namespace weft::photo
