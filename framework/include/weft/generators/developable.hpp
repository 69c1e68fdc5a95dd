// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>

namespace weft {

/// One part of a curvature profile: amplitude * sin(2 pi s / period + phase).
struct CurvatureWave {
  double amplitude_per_m = 0.0;  ///< [] 1/m, amplitude of the curvature
  double period_m = 1.0;         ///< [] m, wavelength, > 0
  double phase_rad = 0.0;        ///< [] rad, phase at the centre
};

/// Bend of a flat surface around parallel straight rulings. The curvature varies along (cos a, sin
/// a) in the surface; the rulings run along (-sin a, cos a), with a = ruling_angle_rad. Positive
/// curvature turns the hollow side to +z, away from a camera in front of the surface.
struct SheetBend {
  double ruling_angle_rad = 0.0;       ///< [] rad, angle a of the curvature's direction
  double constant_per_m = 0.0;         ///< [] 1/m, reciprocal of a cylinder's radius
  std::vector<CurvatureWave> waves{};  ///< [.] waves added to the constant

  /// Curvature at s m from the centre, in 1/m.
  double curvature_per_m(double s_m) const {
    double sum = constant_per_m;
    for (const CurvatureWave& w : waves) {
      sum += w.amplitude_per_m * std::sin(2.0 * M_PI / w.period_m * s_m + w.phase_rad);
    }
    return sum;
  }

  /// Angle by which the surface has turned since the centre, in rad: the integral of the curvature.
  double turn_rad(double s_m) const {
    double sum = constant_per_m * s_m;
    for (const CurvatureWave& w : waves) {
      const double frequency = 2.0 * M_PI / w.period_m;
      sum += w.amplitude_per_m / frequency *
             (std::cos(w.phase_rad) - std::cos(frequency * s_m + w.phase_rad));
    }
    return sum;
  }
};

/// An isometric deformation of a flat surface with exact ground truth: a generalised cylinder
/// followed by a rigid motion. Let s and t be the coordinates of (x,y) - centre across and along
/// the rulings. The point is camera_from_template * (centre + c(s) + t * ruling). The plane curve c
/// has unit speed and the given curvature. The centre keeps its position and tangent plane. c is
/// tabulated with Gauss-Legendre quadrature and read by quintic Hermite interpolation; lengths are
/// exact to better than 1e-9. A strongly bent surface may intersect itself.
class DevelopableSheet {
 public:
  /// Bends the part within `reach_m` of the centre (half of the surface's diagonal); the surface is
  /// flat beyond. Fails on non-finite numbers, on reach or period <= 0, and on profiles with more
  /// than about 10000 rad of turn or phase over the surface.
  static Result<DevelopableSheet> create(const Eigen::Vector2d& centre_m, double reach_m,
                                         SheetBend bend,
                                         const Eigen::Isometry3d& camera_from_template) {
    double fastest_per_m = std::abs(bend.constant_per_m);
    bool legal = std::isfinite(bend.ruling_angle_rad) && std::isfinite(reach_m) && reach_m > 0.0 &&
                 centre_m.allFinite() && camera_from_template.matrix().allFinite();
    for (const CurvatureWave& wave : bend.waves) {
      legal = legal && wave.period_m > 0.0 && std::isfinite(wave.period_m + wave.phase_rad);
      fastest_per_m += std::abs(wave.amplitude_per_m) + 2.0 * M_PI / wave.period_m;
    }
    const double intervals = std::ceil(reach_m * fastest_per_m / kTurnPerInterval);
    if (!legal || !(intervals <= 1e6)) {
      return Error{Errc::invalid_value,
                   "a bent surface needs finite numbers, reach and periods above 0 and a curvature "
                   "that does not turn it more than 10000 rad: correct the profile"};
    }
    DevelopableSheet sheet(centre_m, std::move(bend), camera_from_template);
    sheet.tabulate(reach_m, std::max(8, static_cast<int>(intervals)));
    return sheet;
  }

  /// The point of the surface at template position (x,y) in m, in the camera frame, m.
  Eigen::Vector3d at(double x_m, double y_m) const {
    return camera_from_template_ * bent(x_m, y_m);
  }

  /// The same point in the template frame, m.
  Eigen::Vector3d bent(double x_m, double y_m) const {
    const Eigen::Vector2d offset = Eigen::Vector2d(x_m, y_m) - centre_m_;
    const double along = ruling_.dot(offset);
    const Eigen::Vector2d curve = curve_at(across_.dot(offset));
    const Eigen::Vector2d in_plane = centre_m_ + curve.x() * across_ + along * ruling_;
    return {in_plane.x(), in_plane.y(), curve.y()};
  }

  /// The unit normal in the camera frame; (0,0,-1), towards the camera, for an unmoved flat
  /// surface.
  Eigen::Vector3d normal(double x_m, double y_m) const {
    const double s = across_.dot(Eigen::Vector2d(x_m, y_m) - centre_m_);
    const double turn = bend_.turn_rad(std::clamp(s, -reach_m_, reach_m_));
    const Eigen::Vector2d in_plane = std::sin(turn) * across_;
    return camera_from_template_.linear() *
           Eigen::Vector3d(in_plane.x(), in_plane.y(), -std::cos(turn));
  }

  const SheetBend& bend() const { return bend_; }
  const Eigen::Isometry3d& camera_from_template() const { return camera_from_template_; }

 private:
  static constexpr double kTurnPerInterval = 0.01;

  /// The curve and its first two derivatives at one s.
  struct Node {
    Eigen::Vector2d position, tangent, second;  ///< [2] m, [2] unit vector, [2] 1/m
  };

  DevelopableSheet(const Eigen::Vector2d& centre_m, SheetBend bend,
                   const Eigen::Isometry3d& camera_from_template)
      : centre_m_(centre_m),
        bend_(std::move(bend)),
        camera_from_template_(camera_from_template),
        across_(std::cos(bend_.ruling_angle_rad), std::sin(bend_.ruling_angle_rad)),
        ruling_(-across_.y(), across_.x()) {}

  Eigen::Vector2d tangent_at(double s) const {
    const double turn = bend_.turn_rad(s);
    return {std::cos(turn), std::sin(turn)};
  }

  /// Tabulates `half` intervals on each side of the centre, which is a node.
  void tabulate(double reach_m, int half) {
    reach_m_ = reach_m;
    step_m_ = reach_m / half;
    nodes_.resize(2 * to_index(half) + 1);
    Eigen::Vector2d position = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const double s = (static_cast<double>(i) - half) * step_m_;
      if (i > 0) position += integrate(s - step_m_);
      const Eigen::Vector2d tangent = tangent_at(s);
      const Eigen::Vector2d second =
          bend_.curvature_per_m(s) * Eigen::Vector2d(-tangent.y(), tangent.x());
      nodes_[i] = {position, tangent, second};
    }
    const Eigen::Vector2d centre = nodes_[to_index(half)].position;
    for (Node& node : nodes_) node.position -= centre;
  }

  /// The integral of the tangent over one step (Gauss-Legendre with 4 nodes).
  Eigen::Vector2d integrate(double from) const {
    constexpr double kNodes[] = {0.33998104358485626480, 0.86113631159405257522};
    constexpr double kWeights[] = {0.65214515486254614263, 0.34785484513745385737};
    const double half = 0.5 * step_m_;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int k = 0; k < 2; ++k) {
      sum += kWeights[k] * (tangent_at(from + half * (1.0 - kNodes[k])) +
                            tangent_at(from + half * (1.0 + kNodes[k])));
    }
    return half * sum;
  }

  Eigen::Vector2d curve_at(double s) const {
    if (s <= -reach_m_) return nodes_.front().position + (s + reach_m_) * nodes_.front().tangent;
    if (s >= reach_m_) return nodes_.back().position + (s - reach_m_) * nodes_.back().tangent;
    const double place = (s + reach_m_) / step_m_;
    const std::size_t i = std::min(to_index(place), nodes_.size() - 2);
    const double x = place - static_cast<double>(i), r = 1.0 - x, h = step_m_;
    const Node &a = nodes_[i], &b = nodes_[i + 1];
    const double x3 = x * x * x, r3 = r * r * r;
    return r3 * ((1.0 + 3.0 * x + 6.0 * x * x) * a.position + h * x * (1.0 + 3.0 * x) * a.tangent +
                 0.5 * h * h * x * x * a.second) +
           x3 * ((1.0 + 3.0 * r + 6.0 * r * r) * b.position - h * r * (1.0 + 3.0 * r) * b.tangent +
                 0.5 * h * h * r * r * b.second);
  }

  Eigen::Vector2d centre_m_;
  SheetBend bend_;
  Eigen::Isometry3d camera_from_template_;
  Eigen::Vector2d across_, ruling_;
  double reach_m_ = 0.0;
  double step_m_ = 0.0;
  std::vector<Node> nodes_;
};

}  // namespace weft
