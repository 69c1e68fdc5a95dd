// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "common/tests/npz_archive.hpp"

namespace weft::testing {

/// A data set in the form of third-party data: photographs of a flat texture under known poses.
/// Each photograph also shows a smaller copy of the texture, which is not the object. The masks
/// exclude the copy. True points are on the texture's left half (`visible`), and on a surface 5 mm
/// behind its right half (`hidden`).
class ForeignData {
 public:
  static constexpr int kWidthPx = 640, kHeightPx = 480;
  static constexpr double kFocalPx = 600.0, kWidthM = 0.297, kBehindM = 0.005;
  static constexpr int kFrames = 3;

  /// Writes images, masks, a camera file and truth into `folder`, which has the folders frames,
  /// masks, gt/visible and gt/hidden.
  ForeignData(std::string folder, const std::string& texture_file)
      : folder_(std::move(folder)), texture_(cv::imread(texture_file, cv::IMREAD_GRAYSCALE)) {
    pitch_m_ = kWidthM / texture_.cols;
    write("camera.json",
          "{\"fx\": 600, \"fy\": 600, \"cx\": 319.5, \"cy\": 239.5, "
          "\"width\": 640, \"height\": 480, \"distortion\": null}");
    for (int frame = 0; frame < kFrames; ++frame) write_images(frame);
    write_points("gt/visible/shot_0.csv");
    write_ply("gt/hidden/shot_0.ply", cloud(0, true), true);
    write_csv("gt/visible/shot_1.csv", cloud(1, false));
    write_npz("gt/hidden/shot_1.npz", cloud(1, true));
    write_ply("gt/visible/shot_2.ply", cloud(2, false), false);
    write_csv("gt/hidden/shot_2.csv", cloud(2, true));
  }

  static std::string stem(int frame) { return "shot_" + std::to_string(frame); }

  /// Where texel (u, v) is in the camera frame, m.
  Eigen::Vector3d place(int frame, double u, double v) const {
    const double angle = angle_of(frame);
    const Eigen::Vector3d right(std::cos(angle), 0.0, std::sin(angle)), down(0.0, 1.0, 0.0);
    const Eigen::Vector3d centre(0.0, 0.0, 0.6);
    return centre + pitch_m_ * ((u - 0.5 * (texture_.cols - 1)) * right +
                                (v - 0.5 * (texture_.rows - 1)) * down);
  }

  /// The plane's unit normal, away from the camera.
  static Eigen::Vector3d normal(int frame) {
    return {-std::sin(angle_of(frame)), 0.0, std::cos(angle_of(frame))};
  }

  /// A grid on the left half of the textured surface, or behind its right half.
  std::vector<Eigen::Vector3d> cloud(int frame, bool hidden) const {
    std::vector<Eigen::Vector3d> points;
    for (int j = 0; j < kRows; ++j) {
      for (int i = 0; i < kColumns; ++i) {
        points.push_back(place(frame, u_of(i, hidden), v_of(j)) +
                         (hidden ? kBehindM : 0.0) * normal(frame));
      }
    }
    return points;
  }

  const cv::Mat& mask() const { return mask_; }  ///< mask of the last frame

 private:
  static constexpr int kColumns = 40, kRows = 60;
  static double angle_of(int frame) { return 0.15 + 0.1 * frame; }
  double u_of(int i, bool hidden) const {
    const double half = 0.5 * texture_.cols;
    return (hidden ? half : 0.0) + half * (i + 0.5) / kColumns;
  }
  double v_of(int j) const { return texture_.rows * (j + 0.5) / kRows; }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ + "/" + name, std::ios::binary) << text;
  }

  cv::Mat homography(int frame) const {
    std::vector<cv::Point2f> texels, pixels;
    for (const auto& [u, v] :
         {std::pair{0, 0}, std::pair{1, 0}, std::pair{1, 1}, std::pair{0, 1}}) {
      const Eigen::Vector2d texel(u * (texture_.cols - 1), v * (texture_.rows - 1));
      const Eigen::Vector3d point = place(frame, texel.x(), texel.y());
      texels.emplace_back(static_cast<float>(texel.x()), static_cast<float>(texel.y()));
      pixels.emplace_back(static_cast<float>(kFocalPx * point.x() / point.z() + 319.5),
                          static_cast<float>(kFocalPx * point.y() / point.z() + 239.5));
    }
    return cv::getPerspectiveTransform(texels, pixels);
  }

  void write_images(int frame) {
    const cv::Size size(kWidthPx, kHeightPx);
    const cv::Mat way = homography(frame);
    cv::Mat print, soft;
    cv::GaussianBlur(texture_, soft, {}, 1.0);
    cv::warpPerspective(soft, print, way, size, cv::INTER_LINEAR);
    cv::warpPerspective(cv::Mat(texture_.size(), CV_8UC1, cv::Scalar(255)), mask_, way, size,
                        cv::INTER_NEAREST);
    cv::Mat image(size, CV_8UC1, cv::Scalar(120)), copy;
    cv::resize(soft, copy, {150, 106}, 0, 0, cv::INTER_AREA);
    copy.copyTo(image(cv::Rect(5, 360, 150, 106)));
    print.copyTo(image, mask_);
    cv::imwrite(folder_ + "/frames/" + stem(frame) + ".png", image);
    cv::imwrite(folder_ + "/masks/" + stem(frame) + ".png", mask_);
  }

  /// The visible half of frame 0 with its template points.
  void write_points(const std::string& name) const {
    std::string text = "point_id,template_x_mm,template_y_mm,u_px,v_px,X_mm,Y_mm,Z_mm\n";
    for (int j = 0; j < kRows; ++j) {
      for (int i = 0; i < kColumns; ++i) {
        const Eigen::Vector2d texel(u_of(i, false), v_of(j));
        const Eigen::Vector3d point = 1e3 * place(0, texel.x(), texel.y());
        text += std::to_string(j * kColumns + i);
        for (const double value : {1e3 * pitch_m_ * texel.x(), 1e3 * pitch_m_ * texel.y(), 0.0, 0.0,
                                   point.x(), point.y(), point.z()}) {
          text += "," + std::to_string(value);
        }
        text += "\n";
      }
    }
    write(name, text);
  }

  void write_csv(const std::string& name, const std::vector<Eigen::Vector3d>& points) const {
    std::string text = "X_mm,Y_mm,Z_mm\n";
    for (const Eigen::Vector3d& point : points) {
      text += std::to_string(1e3 * point.x()) + "," + std::to_string(1e3 * point.y()) + "," +
              std::to_string(1e3 * point.z()) + "\n";
    }
    write(name, text);
  }

  /// In millimetres, as scanners do.
  void write_ply(const std::string& name, const std::vector<Eigen::Vector3d>& points,
                 bool faces) const {
    const int cells = (kColumns - 1) * (kRows - 1);
    std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points.size()) +
                       "\nproperty double x\nproperty double y\nproperty double z\n";
    if (faces) {
      text += "element face " + std::to_string(cells) + "\nproperty list uchar int vertex_index\n";
    }
    text += "end_header\n";
    for (const Eigen::Vector3d& point : points) {
      text += std::to_string(1e3 * point.x()) + " " + std::to_string(1e3 * point.y()) + " " +
              std::to_string(1e3 * point.z()) + "\n";
    }
    for (int cell = 0; faces && cell < cells; ++cell) {
      const int a = cell / (kColumns - 1) * kColumns + cell % (kColumns - 1);
      text += "4 " + std::to_string(a) + " " + std::to_string(a + 1) + " " +
              std::to_string(a + kColumns + 1) + " " + std::to_string(a + kColumns) + "\n";
    }
    write(name, text);
  }

  void write_npz(const std::string& name, const std::vector<Eigen::Vector3d>& points) const {
    Array<float> values({static_cast<std::int64_t>(points.size()), 3});
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        values(static_cast<std::int64_t>(i), k) = static_cast<float>(1e3 * points[i][k]);
      }
    }
    write_archive(folder_ + "/" + name, {{"points.npy", npy(values)}});
  }

  std::string folder_;
  cv::Mat texture_;
  cv::Mat mask_;
  double pitch_m_ = 0.0;
};

}  // namespace weft::testing
