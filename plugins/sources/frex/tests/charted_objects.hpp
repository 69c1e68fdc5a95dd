// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <string>

namespace weft::testing {

/// Writes OBJ files of surfaces that are made of grids, each with its own rectangle of the texture.
/// Places at the borders of grids are equal, so that charts meet at seams.
class ObjWriter {
 public:
  /// A place for (s, t) in [0,1]^2: s to the right and t upwards, seen from outside.
  using Grid = std::function<Eigen::Vector3d(double s, double t)>;

  /// `box` is left, bottom, width and height in the texture, from 0 to 1.
  void add(const Grid& place, int columns, int rows, const Eigen::Vector4d& box) {
    const int first = count_ + 1;
    for (int j = 0; j <= rows; ++j) {
      for (int i = 0; i <= columns; ++i, ++count_) {
        const double s = static_cast<double>(i) / columns, t = static_cast<double>(j) / rows;
        // Rounded, so that both sides of a seam are equal to the last digit.
        const Eigen::Vector3d at = (1e5 * place(s, t)).array().round() / 1e5;
        places_ += line("v", {at.x() + 0.0, at.y() + 0.0, at.z() + 0.0});
        texture_ += line("vt", {box[0] + s * box[2], box[1] + t * box[3]});
      }
    }
    const auto corner = [&](int i, int j) {
      const std::string v = std::to_string(first + j * (columns + 1) + i);
      return " " + v + "/" + v;
    };
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        faces_ += "f" + corner(i, j) + corner(i + 1, j) + corner(i + 1, j + 1) + "\n";
        faces_ += "f" + corner(i, j) + corner(i + 1, j + 1) + corner(i, j + 1) + "\n";
      }
    }
  }

  /// The path of the file.
  std::string write(const std::string& name) const {
    const std::string path = ::testing::TempDir() + "frex_" + name + ".obj";
    std::ofstream(path) << places_ << texture_ << faces_;
    return path;
  }

 private:
  static std::string line(const char* kind, std::initializer_list<double> numbers) {
    std::string text = kind;
    for (const double number : numbers) text += " " + std::to_string(number);
    return text + "\n";
  }

  int count_ = 0;
  std::string places_, texture_, faces_;
};

/// mm: a box of six charts, x long, y wide, z thick.
inline std::string box_obj(double x, double y, double z, int columns = 8) {
  const Eigen::Vector3d half = 0.5 * Eigen::Vector3d(x, y, z);
  ObjWriter obj;
  int chart = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      const Eigen::Vector3d out = side * Eigen::Vector3d::Unit(axis);
      const Eigen::Vector3d up = Eigen::Vector3d::Unit((axis + 1) % 3), right = up.cross(out);
      const auto place = [&](double s, double t) -> Eigen::Vector3d {
        return half.cwiseProduct(out + (2.0 * s - 1.0) * right + (2.0 * t - 1.0) * up);
      };
      obj.add(place, columns, columns,
              {0.02 + 0.33 * (chart % 3), 0.02 + 0.5 * (chart / 3), 0.29, 0.46});
      ++chart;
    }
  }
  return obj.write("box");
}

/// mm: a body, unrolled with its seam at the back, and one lid or two.
inline std::string can_obj(double radius, double height, int lids) {
  constexpr int kAround = 32, kRings = 4;
  const auto rim = [=](double turn, double r, double y) {
    const double angle = 2.0 * M_PI * turn;
    return Eigen::Vector3d(r * std::sin(angle), y, r * std::cos(angle));
  };
  ObjWriter obj;
  obj.add([&](double s, double t) { return rim(s - 0.5, radius, height * (t - 0.5)); }, kAround, 8,
          {0.02, 0.5, 0.96, 0.46});
  for (int lid = 0; lid < lids; ++lid) {
    // A square grid, bent into a disc: its border comes to the vertices of the body's rim.
    const double up = lid == 0 ? 1.0 : -1.0;
    const auto place = [&](double s, double t) -> Eigen::Vector3d {
      const double a = 2.0 * s - 1.0, b = 2.0 * t - 1.0;
      const double ring = std::max(std::abs(a), std::abs(b));
      if (ring <= 0.0) return {0.0, 0.5 * up * height, 0.0};
      // The place on the square, in eighths of its border, from the middle of a side.
      const double eighth = std::abs(a) >= std::abs(b)
                                ? (a > 0.0 ? b / ring : 4.0 - b / ring)
                                : (b > 0.0 ? 2.0 - a / ring : 6.0 + a / ring);
      return rim(up * (eighth / 8.0 + 0.25) + (up < 0.0 ? 0.5 : 0.0), ring * radius,
                 0.5 * up * height);
    };
    obj.add(place, 2 * kRings, 2 * kRings, {0.02 + 0.5 * lid, 0.02, 0.3, 0.44});
  }
  return obj.write("can" + std::to_string(lids));
}

/// mm: a cushion of two charts that meet at its rim.
inline std::string cushion_obj(double side, double height) {
  ObjWriter obj;
  for (const double out : {1.0, -1.0}) {
    const auto place = [&](double s, double t) -> Eigen::Vector3d {
      const double a = 2.0 * s - 1.0, b = 2.0 * t - 1.0;
      return {0.5 * out * side * a, 0.5 * side * b,
              0.5 * out * height * std::sqrt((1.0 - a * a) * (1.0 - b * b))};
    };
    obj.add(place, 12, 12, {out > 0.0 ? 0.02 : 0.52, 0.1, 0.46, 0.8});
  }
  return obj.write("cushion");
}

}  // namespace weft::testing
