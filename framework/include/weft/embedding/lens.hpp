// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>

namespace weft {

/// A calibrated lens in memory. It maps images and pixels of the real camera to those of the ideal
/// pinhole with the same fx, fy, cx, cy and size, which Pipeline::process() takes. The models and
/// the order of their coefficients are those of OpenCV.
///
/// The real camera shows a point at (fx x' + cx, fy y' + cy). Here x = X/Z, y = Y/Z,
/// r^2 = x^2 + y^2, and theta = atan r.
///   brown    x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
///                 + 2 p1 x y + p2 (r^2 + 2 x^2), y' alike.
///   fisheye  x' = x / r * theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), y' alike
class Lens {
 public:
  enum class Model { brown, fisheye };

  /// `coefficients`: brown k1 k2 p1 p2, then k3, then k4 k5 k6; fisheye k1 k2 k3 k4. Refuses other
  /// numbers of them, values that are not finite, and a lens that maps two pixels of the ideal
  /// image to one.
  static Result<Lens> make(const Camera& camera, Model model, std::vector<double> coefficients) {
    const std::size_t count = coefficients.size();
    const bool is_brown = model == Model::brown;
    if (is_brown ? count != 4 && count != 5 && count != 8 : count != 4) {
      return Error{Errc::invalid_value,
                   "has " + std::to_string(count) + " coefficients; give " +
                       (is_brown ? "k1 k2 p1 p2, then k3, then k4 k5 k6" : "k1 k2 k3 k4"),
                   "lens"};
    }
    for (const double each : coefficients) {
      if (!std::isfinite(each)) {
        return Error{Errc::invalid_value, "has a coefficient that is not finite", "lens"};
      }
    }
    if (!(camera.fx > 0 && camera.fy > 0 && camera.width_px > 0 && camera.height_px > 0)) {
      return Error{Errc::invalid_value, "has a camera without a focal length or size", "lens"};
    }
    coefficients.resize(8, 0.0);
    Lens lens(camera, model, std::move(coefficients));
    constexpr int kProbes = 16;
    for (int i = 0; i <= kProbes; ++i) {
      for (int j = 0; j <= kProbes; ++j) {
        const double x_px = static_cast<double>(camera.width_px) * i / kProbes - 0.5;
        const double y_px = static_cast<double>(camera.height_px) * j / kProbes - 0.5;
        if (lens.jacobian(x_px, y_px).determinant() > 0.0) continue;
        return Error{Errc::invalid_value,
                     "folds the image at pixel (" + std::to_string(std::lround(x_px)) + ", " +
                         std::to_string(std::lround(y_px)) +
                         "): check the order and the signs of its coefficients",
                     "lens"};
      }
    }
    return lens;
  }

  /// The ideal pinhole, for Pipeline::load().
  const Camera& camera() const { return camera_; }

  /// Where the real camera shows what the ideal pinhole has at a pixel, px.
  std::array<double, 2> seen_px(double x_px, double y_px) const {
    const double x = (x_px - camera_.cx) / camera_.fx, y = (y_px - camera_.cy) / camera_.fy;
    const double r2 = x * x + y * y;
    const std::vector<double>& k = coefficients_;
    double u = x, v = y;
    if (model_ == Model::fisheye) {
      const double r = std::sqrt(r2), theta = std::atan(r), t2 = theta * theta;
      const double scale = theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
      if (r > 0.0) u = scale / r * x, v = scale / r * y;
    } else {
      const double over = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
      const double under = 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
      u = over / under * x + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x);
      v = over / under * y + 2.0 * k[3] * x * y + k[2] * (r2 + 2.0 * y * y);
    }
    return {camera_.fx * u + camera_.cx, camera_.fy * v + camera_.cy};
  }

  /// Pixels [N,2] px of the real camera as those of the ideal pinhole, such as image positions of
  /// matches. Fails for a pixel that is not finite or that the lens shows nowhere.
  Result<Array<double>> ideal_px(const Array<double>& seen) const {
    if (seen.ndim() != 2 || seen.dim(1) != 2) {
      return Error{Errc::invalid_data, "pixels must be [N,2]", "lens"};
    }
    Array<double> ideal({seen.rows(), 2});
    for (std::int64_t i = 0; i < seen.rows(); ++i) {
      double x_px = seen(i, 0), y_px = seen(i, 1);
      double error_px = 1.0;
      for (int step = 0; step < 50 && error_px > 1e-9; ++step) {
        const auto [u_px, v_px] = seen_px(x_px, y_px);
        const double du = seen(i, 0) - u_px, dv = seen(i, 1) - v_px;
        error_px = std::hypot(du, dv);
        const Jacobian j = jacobian(x_px, y_px);
        x_px += (j.vy * du - j.uy * dv) / j.determinant();
        y_px += (j.ux * dv - j.vx * du) / j.determinant();
      }
      if (!(error_px < 1e-6)) {
        return Error{Errc::invalid_data,
                     "pixel " + std::to_string(i) + " at (" + std::to_string(seen(i, 0)) + ", " +
                         std::to_string(seen(i, 1)) + ") px is none that this lens shows",
                     "lens"};
      }
      ideal(i, 0) = x_px;
      ideal(i, 1) = y_px;
    }
    return ideal;
  }

  /// The image that the ideal pinhole has taken, interpolated bilinearly; black where the real
  /// camera does not look. Fails for another size than the camera's.
  Result<Image> undistorted(const Image& image) const {
    const Array<std::uint8_t>& from = image.pixels;
    const bool is_of_camera = from.present() && from.dim(0) == camera_.height_px &&
                              from.dim(1) == camera_.width_px &&
                              (from.ndim() == 2 || (from.ndim() == 3 && from.dim(2) == 3));
    if (!is_of_camera) {
      return Error{Errc::invalid_data,
                   "must have " + std::to_string(camera_.height_px) + " rows and " +
                       std::to_string(camera_.width_px) +
                       " columns, as the lens's camera, of grey levels or of BGR",
                   "image"};
    }
    const std::int64_t channels = from.dim(2);
    Image ideal = image;
    ideal.pixels = from.ndim() == 2 ? Array<std::uint8_t>({from.dim(0), from.dim(1)}, 0)
                                    : Array<std::uint8_t>({from.dim(0), from.dim(1), channels}, 0);
    for (std::int64_t row = 0; row < from.dim(0); ++row) {
      for (std::int64_t column = 0; column < from.dim(1); ++column) {
        const auto [x_px, y_px] = seen_px(static_cast<double>(column), static_cast<double>(row));
        if (!camera_.shows(x_px, y_px)) continue;
        const auto inside = [](double px, std::int64_t length) {
          return px < 0.0 ? 0.0 : std::fmin(px, static_cast<double>(length - 1));
        };
        const double x = inside(x_px, from.dim(1)), y = inside(y_px, from.dim(0));
        const auto left = static_cast<std::int64_t>(x), top = static_cast<std::int64_t>(y);
        const std::int64_t right = left + (left + 1 < from.dim(1) ? 1 : 0);
        const std::int64_t below = top + (top + 1 < from.dim(0) ? 1 : 0);
        const double a = x - static_cast<double>(left), b = y - static_cast<double>(top);
        for (std::int64_t c = 0; c < channels; ++c) {
          const auto at = [&](std::int64_t r, std::int64_t k) {
            return static_cast<double>(from.row(r)[k * channels + c]);
          };
          const double value = (1 - b) * ((1 - a) * at(top, left) + a * at(top, right)) +
                               b * ((1 - a) * at(below, left) + a * at(below, right));
          ideal.pixels.row(row)[column * channels + c] = static_cast<std::uint8_t>(value + 0.5);
        }
      }
    }
    return ideal;
  }

 private:
  struct Jacobian {
    double ux, uy, vx, vy;
    double determinant() const { return ux * vy - uy * vx; }
  };

  Lens(Camera camera, Model model, std::vector<double> coefficients)
      : camera_(std::move(camera)), model_(model), coefficients_(std::move(coefficients)) {}

  /// Central differences over a hundredth of a pixel.
  Jacobian jacobian(double x_px, double y_px) const {
    constexpr double kStep = 0.005;
    const auto [ua, va] = seen_px(x_px + kStep, y_px);
    const auto [ub, vb] = seen_px(x_px - kStep, y_px);
    const auto [uc, vc] = seen_px(x_px, y_px + kStep);
    const auto [ud, vd] = seen_px(x_px, y_px - kStep);
    const double over = 0.5 / kStep;
    return {(ua - ub) * over, (uc - ud) * over, (va - vb) * over, (vc - vd) * over};
  }

  Camera camera_;
  Model model_;
  std::vector<double> coefficients_;  ///< [8] or, of a fisheye, the first 4 of them
};

}  // namespace weft
