// SPDX-License-Identifier: Apache-2.0
#include "sheet_surface.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/geometry/bspline_site.hpp>

namespace weft::frex_video {
namespace {

constexpr double kKnotSpacing_m = 0.025;
constexpr int kMostControlPoints = 24;  // along a side
constexpr double kPixel_px = 0.25;      // s_px
constexpr double kHuber = 4.0;
constexpr double kStrain = 0.001;     // s_strain
constexpr double kBend_per_m = 20.0;  // s_bend
constexpr double kRough = 0.05;       // s_depth
constexpr double kStart = 0.01;       // the same for the first surface, in all directions
constexpr double kWorstFit_px = 3.0;
constexpr int kLocal = 48;  // coordinates of the 16 control points that a place depends on
template <int Rows>
using Jacobian = Eigen::Matrix<double, Rows, kLocal>;

/// The derivatives of the spline at one place: both depend on the same control points.
struct Place {
  SplineSite x, y;

  Place(const SplineDomain& domain, const Eigen::Vector2d& p)
      : x(spline_site(domain, p.x(), p.y(), 1, 0)), y(spline_site(domain, p.x(), p.y(), 0, 1)) {}
};

/// d(sum_k weight_k C_k) / dC, times `factor` [Rows,3] from the left.
template <int Rows>
Jacobian<Rows> chain(const SplineSite& site, const Eigen::Matrix<double, Rows, 3>& factor) {
  Jacobian<Rows> jacobian;
  for (int k = 0; k < 16; ++k) {
    jacobian.template middleCols<3>(3 * k) = site.weights[to_index(k)] * factor;
  }
  return jacobian;
}

/// Half the sum of squared residuals near given control points: cost + g^T d + d^T H d / 2.
class Quadratic {
 public:
  explicit Quadratic(const SplineDomain& domain) : domain_(domain) {
    const Eigen::Index size = 3 * domain.control_count();
    hessian_ = Eigen::MatrixXd::Zero(size, size);
    gradient_ = Eigen::VectorXd::Zero(size);
  }

  template <int Rows>
  void add(const SplineSite& site, const Jacobian<Rows>& jacobian,
           const Eigen::Matrix<double, Rows, 1>& residual, double weight) {
    const Eigen::Matrix<double, kLocal, kLocal> h = weight * jacobian.transpose() * jacobian;
    const Eigen::Matrix<double, kLocal, 1> g = weight * jacobian.transpose() * residual;
    for (int a = 0; a < 16; ++a) {
      const Eigen::Index row = 3 * index(site, a);
      gradient_.segment<3>(row) += g.segment<3>(3 * a);
      for (int b = 0; b < 16; ++b) {
        hessian_.block<3, 3>(row, 3 * index(site, b)) += h.block<3, 3>(3 * a, 3 * b);
      }
    }
  }

  /// The step to the minimum, each coordinate damped in proportion to its own curvature.
  Eigen::VectorXd step(double damping) const {
    Eigen::MatrixXd damped = hessian_;
    damped.diagonal() *= 1.0 + damping;
    return Eigen::LLT<Eigen::MatrixXd>(damped).solve(-gradient_);
  }

 private:
  Eigen::Index index(const SplineSite& site, int k) const {
    return domain_.control_index(site.i + k / 4, site.j + k % 4);
  }

  SplineDomain domain_;
  Eigen::MatrixXd hessian_;
  Eigen::VectorXd gradient_;
};

SplineDomain domain_of(const Eigen::Vector2d& size_m) {
  const auto count = [](double length_m) {
    return std::clamp(static_cast<int>(std::ceil(length_m / kKnotSpacing_m)) + 3, 4,
                      kMostControlPoints);
  };
  return {0.0, size_m.x(), 0.0, size_m.y(), count(size_m.x()), count(size_m.y())};
}

/// Places all over the paper, two in each direction between two knots.
std::vector<Eigen::Vector2d> quadrature(const SplineDomain& domain) {
  std::vector<Eigen::Vector2d> places;
  const int columns = 2 * (domain.nu - 3), rows = 2 * (domain.nv - 3);
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      places.emplace_back((i + 0.5) * domain.u1 / columns, (j + 0.5) * domain.v1 / rows);
    }
  }
  return places;
}

/// The terms of the objective; each adds itself to a quadratic, if there is one, and its cost.
class Objective {
 public:
  Objective(const SplineDomain& domain, const SheetSightings& sightings, const Pinhole& camera)
      : domain_(domain), sightings_(sightings), camera_(camera), places_(quadrature(domain)) {}

  double evaluate(const Points3& control, Quadratic* quadratic) const {
    return add_corners(control, quadratic) + add_lengths(control, quadratic) +
           add_bending(control, quadratic) + add_depths(control, quadratic);
  }

  /// The control points of the smooth surface near the rough points: a linear problem.
  Points3 start() const {
    Points3 control = Points3::Zero(domain_.control_count(), 3);
    Quadratic quadratic(domain_);
    add_bending(control, &quadratic);
    for (Eigen::Index i = 0; i < sightings_.centres_m.rows(); ++i) {
      const Eigen::Vector3d rough = sightings_.rough_centres_m.row(i);
      if (!rough.allFinite()) continue;
      const SplineSite site = site_of(sightings_.centres_m, i);
      quadratic.add<3>(site, chain<3>(site, Eigen::Matrix3d::Identity()), -rough,
                       1.0 / std::pow(kStart * rough.z(), 2));
    }
    return stepped(control, quadratic.step(1e-9));
  }

  static Points3 stepped(const Points3& control, const Eigen::VectorXd& step) {
    return control + Eigen::Map<const Points3>(step.data(), control.rows(), 3);
  }

  double rms_px(const Points3& control) const {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < sightings_.corners_m.rows(); ++i) {
      sum += (project(camera_, corner(control, i)) - sightings_.corners_px.row(i).transpose())
                 .squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(sightings_.corners_m.rows()));
  }

  double rms_strain(const Points3& control) const {
    double sum = 0.0;
    for (const Eigen::Vector2d& p : places_) {
      const Place place(domain_, p);
      sum += std::pow(evaluate_site(domain_, place.x, control).norm() - 1.0, 2) +
             std::pow(evaluate_site(domain_, place.y, control).norm() - 1.0, 2);
    }
    return std::sqrt(0.5 * sum / static_cast<double>(places_.size()));
  }

 private:
  SplineSite site_of(const Points2& places_m, Eigen::Index i) const {
    return spline_site(domain_, places_m(i, 0), places_m(i, 1));
  }

  Eigen::Vector3d corner(const Points3& control, Eigen::Index i) const {
    return evaluate_site(domain_, site_of(sightings_.corners_m, i), control);
  }

  double add_corners(const Points3& control, Quadratic* quadratic) const {
    double cost = 0.0;
    for (Eigen::Index i = 0; i < sightings_.corners_m.rows(); ++i) {
      const SplineSite site = site_of(sightings_.corners_m, i);
      const Eigen::Vector3d point = evaluate_site(domain_, site, control);
      if (!(point.z() > 0.0)) return std::numeric_limits<double>::infinity();
      const Eigen::Vector2d residual =
          (project(camera_, point) - sightings_.corners_px.row(i).transpose()) / kPixel_px;
      const double length = residual.norm();
      const bool is_far = length > kHuber;
      cost += is_far ? kHuber * (length - 0.5 * kHuber) : 0.5 * length * length;
      if (quadratic == nullptr) continue;
      Eigen::Matrix<double, 2, 3> projection;
      projection << camera_.fx, 0.0, -camera_.fx * point.x() / point.z(), 0.0, camera_.fy,
          -camera_.fy * point.y() / point.z();
      projection /= point.z() * kPixel_px;
      quadratic->add<2>(site, chain<2>(site, projection), residual, is_far ? kHuber / length : 1.0);
    }
    return cost;
  }

  double add_lengths(const Points3& control, Quadratic* quadratic) const {
    double cost = 0.0;
    for (const Eigen::Vector2d& p : places_) {
      const Place place(domain_, p);
      const Eigen::Vector3d along_x = evaluate_site(domain_, place.x, control);
      const Eigen::Vector3d along_y = evaluate_site(domain_, place.y, control);
      // E - 1 is twice the strain, for small ones, and F the change of the angle.
      const Eigen::Vector3d residual(0.5 * (along_x.squaredNorm() - 1.0), along_x.dot(along_y),
                                     0.5 * (along_y.squaredNorm() - 1.0));
      cost += 0.5 * residual.squaredNorm() / (kStrain * kStrain);
      if (quadratic == nullptr) continue;
      Eigen::Matrix3d by_x = Eigen::Matrix3d::Zero(), by_y = Eigen::Matrix3d::Zero();
      by_x.row(0) = along_x;
      by_x.row(1) = along_y;
      by_y.row(1) = along_x;
      by_y.row(2) = along_y;
      quadratic->add<3>(place.x, chain<3>(place.x, by_x) + chain<3>(place.y, by_y), residual,
                        1.0 / (kStrain * kStrain));
    }
    return cost;
  }

  double add_bending(const Points3& control, Quadratic* quadratic) const {
    constexpr int kOrders[3][2] = {{2, 0}, {1, 1}, {0, 2}};
    constexpr double kFactors[3] = {1.0, 2.0, 1.0};  // the mixed derivative stands for two
    double cost = 0.0;
    for (const Eigen::Vector2d& p : places_) {
      for (int k = 0; k < 3; ++k) {
        const SplineSite site = spline_site(domain_, p.x(), p.y(), kOrders[k][0], kOrders[k][1]);
        const Eigen::Vector3d residual = evaluate_site(domain_, site, control);
        const double weight = kFactors[k] / (kBend_per_m * kBend_per_m);
        cost += 0.5 * weight * residual.squaredNorm();
        if (quadratic == nullptr) continue;
        quadratic->add<3>(site, chain<3>(site, Eigen::Matrix3d::Identity()), residual, weight);
      }
    }
    return cost;
  }

  double add_depths(const Points3& control, Quadratic* quadratic) const {
    double cost = 0.0;
    for (Eigen::Index i = 0; i < sightings_.centres_m.rows(); ++i) {
      const double rough_m = sightings_.rough_centres_m(i, 2);
      if (!std::isfinite(rough_m)) continue;
      const SplineSite site = site_of(sightings_.centres_m, i);
      const Eigen::Matrix<double, 1, 1> residual(
          (evaluate_site(domain_, site, control).z() - rough_m) / (kRough * rough_m));
      cost += 0.5 * residual.squaredNorm();
      if (quadratic == nullptr) continue;
      const Eigen::RowVector3d depth(0.0, 0.0, 1.0 / (kRough * rough_m));
      quadratic->add<1>(site, chain<1>(site, depth), residual, 1.0);
    }
    return cost;
  }

  const SplineDomain& domain_;
  const SheetSightings& sightings_;
  const Pinhole& camera_;
  std::vector<Eigen::Vector2d> places_;
};

/// Levenberg-Marquardt.
Points3 minimise(const Objective& objective, const SplineDomain& domain, Points3 control) {
  constexpr int kMostSteps = 60;
  constexpr double kSmallest = 1e-9, kLargest = 1e9, kConverged = 1e-7;
  double damping = 1e-3;
  double cost = objective.evaluate(control, nullptr);
  for (int step = 0; step < kMostSteps && damping < kLargest; ++step) {
    Quadratic quadratic(domain);
    objective.evaluate(control, &quadratic);
    while (damping < kLargest) {
      const Points3 moved = Objective::stepped(control, quadratic.step(damping));
      const double moved_cost = objective.evaluate(moved, nullptr);
      if (!(moved_cost < cost)) {
        damping *= 10.0;
        continue;
      }
      const bool has_converged = cost - moved_cost < kConverged * cost;
      control = moved;
      cost = moved_cost;
      damping = std::max(kSmallest, 0.1 * damping);
      if (has_converged) return control;
      break;
    }
  }
  return control;
}

}  // namespace

Result<SheetSurface> SheetSurface::fit(const Eigen::Vector2d& size_m,
                                       const SheetSightings& sightings, const Pinhole& camera) {
  SheetSurface surface;
  surface.domain_ = domain_of(size_m);
  const Objective objective(surface.domain_, sightings, camera);
  surface.control_m_ = minimise(objective, surface.domain_, objective.start());
  surface.rms_px_ = objective.rms_px(surface.control_m_);
  surface.rms_strain_ = objective.rms_strain(surface.control_m_);
  if (!(surface.rms_px_ <= kWorstFit_px)) {
    return no_result(
        "no page that bends without stretching shows its markers there: check the calibration and "
        "the layout");
  }
  return surface;
}

Eigen::Vector3d SheetSurface::at(const Eigen::Vector2d& point_m) const {
  return evaluate_site(domain_, spline_site(domain_, point_m.x(), point_m.y()), control_m_);
}

Eigen::Vector3d SheetSurface::normal(const Eigen::Vector2d& point_m) const {
  const Place place(domain_, point_m);
  const Eigen::Vector3d along_x = evaluate_site(domain_, place.x, control_m_);
  const Eigen::Vector3d along_y = evaluate_site(domain_, place.y, control_m_);
  return along_y.cross(along_x).normalized();
}

}  // namespace weft::frex_video
