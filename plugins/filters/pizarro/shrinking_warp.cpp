// SPDX-License-Identifier: Apache-2.0
#include "shrinking_warp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/bspline_bending.hpp>
#include <weft/geometry/bspline_site.hpp>

namespace weft::pizarro {
namespace {

constexpr int kControlU = 16, kControlV = 12;
constexpr double kMarginPx = 20.0;
constexpr double kBendingPx2 = 500.0;
constexpr int kColumns = 40;         // cells along the texture's width
constexpr double kContracted = 0.2;  // share of the median at the matches
constexpr double kLeastDet = 0.05;   // share of that median: m
constexpr double kFoldedPx = 10.0;   // off all matches: what mu = 1 makes a fold cost
constexpr int kStages = 4, kSteps = 5, kHalvings = 6;
constexpr double kFirstMu = 1e-2, kMuGrowth = 10.0;
constexpr double kRidge = 1e-9;  // share of the largest diagonal element

using Control = Eigen::Matrix<double, Eigen::Dynamic, 2>;  // [nu*nv] px

/// Where the determinant of the Jacobian is looked at.
struct Place {
  SplineSite along_u, along_v;
};

Place place_at(const SplineDomain& domain, double u, double v) {
  return {spline_site(domain, u, v, 1, 0), spline_site(domain, u, v, 0, 1)};
}

/// Determinant of the Jacobian, and its derivatives by the 16 control points' x and y.
struct Determinant {
  double value = 0.0;
  double least_stretch = 0.0;  ///< smaller singular value of the Jacobian
  Eigen::Matrix<double, 16, 2> gradient;
};

class ShrinkingWarp {
 public:
  ShrinkingWarp(const SplineDomain& domain, const Points2& p, const Points2& q) : domain_(domain) {
    const Eigen::Index n = domain.control_count();
    normal_ = kBendingPx2 * Eigen::MatrixXd(bending_matrix(domain));
    moments_ = Control::Zero(n, 2);
    for (Eigen::Index k = 0; k < p.rows(); ++k) {
      const SplineSite site = spline_site(domain, p(k, 0), p(k, 1));
      worked(100);
      for (int a = 0; a < 16; ++a) {
        const double weight = site.weights[to_index(a)];
        moments_.row(control_of(site, a)) += weight * q.row(k);
        for (int b = 0; b < 16; ++b) {
          normal_(control_of(site, a), control_of(site, b)) += weight * site.weights[to_index(b)];
        }
      }
    }
    const double ridge = kRidge * normal_.diagonal().maxCoeff();
    normal_.diagonal().array() += ridge;
    moments_.rowwise() += ridge * q.colwise().mean();
    fold_weight_ = kFoldedPx * kFoldedPx * static_cast<double>(p.rows());
  }

  bool fit() {
    const Eigen::LLT<Eigen::MatrixXd> solver(normal_);
    if (solver.info() != Eigen::Success) return false;
    control_ = solver.solve(moments_);
    return control_.allFinite();
  }

  Determinant determinant(const Place& place) const { return determinant(place, control_); }

  /// Contracts folded parts, `median_det` being that of the plain fit, with the surface's side.
  void shrink(const std::vector<Place>& places, double median_det) {
    double mu = kFirstMu;
    for (int stage = 0; stage < kStages; ++stage) {
      const double weight = mu * fold_weight_ / static_cast<double>(places.size());
      for (int step = 0; step < kSteps; ++step) {
        if (!improve(places, median_det, weight)) break;
      }
      mu *= kMuGrowth;
    }
  }

 private:
  Eigen::Index control_of(const SplineSite& site, int a) const {
    return domain_.control_index(site.i + a / 4, site.j + a % 4);
  }

  Determinant determinant(const Place& place, const Control& control) const {
    const Eigen::Vector2d u = evaluate_site(domain_, place.along_u, control);
    const Eigen::Vector2d v = evaluate_site(domain_, place.along_v, control);
    Determinant found;
    found.value = u.x() * v.y() - u.y() * v.x();
    const double half = 0.5 * (u.squaredNorm() + v.squaredNorm());
    const double spread = std::sqrt(std::max(half * half - found.value * found.value, 0.0));
    found.least_stretch = std::sqrt(std::max(half - spread, 0.0));
    for (int a = 0; a < 16; ++a) {
      const auto k = to_index(a);
      const double du = place.along_u.weights[k], dv = place.along_v.weights[k];
      found.gradient.row(a) << du * v.y() - dv * u.y(), dv * u.x() - du * v.x();
    }
    return found;
  }

  double energy(const std::vector<Place>& places, double median_det, double weight,
                const Control& control) const {
    // But for the constant sum |q|^2.
    double sum = (control.transpose() * (normal_ * control - 2.0 * moments_)).trace();
    for (const Place& place : places) {
      const double lack = kLeastDet - determinant(place, control).value / median_det;
      if (lack > 0.0) sum += weight * lack * lack;
    }
    return sum;
  }

  /// One step of Gauss and Newton, halved until the energy falls; false where it does not.
  bool improve(const std::vector<Place>& places, double median_det, double weight) {
    const Eigen::Index n = domain_.control_count();
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    worked(StopCheck::kPassesPerAsk);  // the factorisation of 384 unknowns takes milliseconds
    system.topLeftCorner(n, n) = system.bottomRightCorner(n, n) = normal_;
    const Control residual = moments_ - normal_ * control_;
    Eigen::VectorXd downhill(2 * n);
    downhill << residual.col(0), residual.col(1);
    for (const Place& place : places) {
      const Determinant det = determinant(place);
      const double lack = kLeastDet - det.value / median_det;
      if (lack > 0.0)
        add_fold(place.along_u, det.gradient / median_det, lack, weight, system, downhill);
    }
    const Eigen::LLT<Eigen::MatrixXd> solver(system);
    if (solver.info() != Eigen::Success) return false;
    const Eigen::VectorXd step = solver.solve(downhill);
    Control direction(n, 2);
    direction << step.head(n), step.tail(n);
    const double before = energy(places, median_det, weight, control_);
    double length = 1.0;
    for (int k = 0; k < kHalvings; ++k) {
      const Control tried = control_ + length * direction;
      if (energy(places, median_det, weight, tried) < before) {
        control_ = tried;
        return true;
      }
      length *= 0.5;
    }
    return false;
  }

  /// One term weight * (lack - g . step)^2.
  void add_fold(const SplineSite& site, const Eigen::Matrix<double, 16, 2>& gradient, double lack,
                double weight, Eigen::MatrixXd& system, Eigen::VectorXd& downhill) const {
    const Eigen::Index n = domain_.control_count();
    for (int a = 0; a < 32; ++a) {
      const Eigen::Index row = control_of(site, a % 16) + a / 16 * n;
      const double own = gradient(a % 16, a / 16);
      downhill[row] += weight * lack * own;
      for (int b = 0; b < 32; ++b) {
        system(row, control_of(site, b % 16) + b / 16 * n) +=
            weight * own * gradient(b % 16, b / 16);
      }
    }
  }

  SplineDomain domain_;
  Eigen::MatrixXd normal_;
  Control moments_, control_;
  double fold_weight_ = 0.0;
};

/// Fills gaps of one cell: grows by one cell all around, then shrinks by one.
void close_gaps(HiddenMap& map) {
  const auto spread = [&](const std::vector<std::uint8_t>& from, std::uint8_t value) {
    std::vector<std::uint8_t> to = from;
    for (int r = 0; r < map.rows; ++r) {
      for (int c = 0; c < map.columns; ++c) {
        for (int k = 0; k < 9; ++k) {
          const int row = std::clamp(r + k / 3 - 1, 0, map.rows - 1);
          const int column = std::clamp(c + k % 3 - 1, 0, map.columns - 1);
          if (from[to_index(row * map.columns + column)] == value) {
            to[to_index(r * map.columns + c)] = value;
          }
        }
      }
    }
    return to;
  };
  map.hidden = spread(spread(map.hidden, 1), 0);
}

}  // namespace

bool HiddenMap::at(double u_px, double v_px) const {
  const int column = static_cast<int>(std::floor((u_px + 0.5) / cell_px));
  const int row = static_cast<int>(std::floor((v_px + 0.5) / cell_px));
  return hidden[to_index(std::clamp(row, 0, rows - 1) * columns +
                         std::clamp(column, 0, columns - 1))] != 0;
}

double HiddenMap::share() const {
  return static_cast<double>(std::count(hidden.begin(), hidden.end(), std::uint8_t{1})) /
         static_cast<double>(std::max<std::size_t>(1, hidden.size()));
}

std::optional<HiddenMap> hidden_by_itself(const Points2& in_template, const Points2& in_image,
                                          const Eigen::RowVector2d& texture_px) {
  const SplineDomain domain{-0.5 - kMarginPx, texture_px.x() - 0.5 + kMarginPx,
                            -0.5 - kMarginPx, texture_px.y() - 0.5 + kMarginPx,
                            kControlU,        kControlV};
  ShrinkingWarp warp(domain, in_template, in_image);
  if (!warp.fit()) return std::nullopt;
  HiddenMap map;
  map.columns = kColumns;
  map.cell_px = texture_px.x() / kColumns;
  map.rows = std::max(1, static_cast<int>(std::lround(texture_px.y() / map.cell_px)));
  std::vector<Place> places;
  for (int r = 0; r < map.rows; ++r) {
    for (int c = 0; c < map.columns; ++c) {
      places.push_back(
          place_at(domain, (c + 0.5) * map.cell_px - 0.5, (r + 0.5) * map.cell_px - 0.5));
    }
  }
  // The usual values come from places where the surface is visible, because the hidden part may be
  // large.
  std::vector<double> determinants, stretches;
  for (Eigen::Index k = 0; k < in_template.rows(); ++k) {
    const Determinant det =
        warp.determinant(place_at(domain, in_template(k, 0), in_template(k, 1)));
    determinants.push_back(det.value);
    stretches.push_back(det.least_stretch);
  }
  const double median_det = median(determinants), median_stretch = median(stretches);
  if (median_det == 0.0) return std::nullopt;
  const bool folds = std::any_of(places.begin(), places.end(), [&](const Place& place) {
    return warp.determinant(place).value / median_det < kLeastDet;
  });
  if (folds) warp.shrink(places, median_det);
  map.least_det = std::numeric_limits<double>::infinity();
  for (const Place& place : places) {
    const Determinant det = warp.determinant(place);
    map.least_det = std::min(map.least_det, det.value / median_det);
    const bool hidden =
        det.value / median_det <= 0.0 || det.least_stretch < kContracted * median_stretch;
    map.hidden.push_back(hidden ? 1 : 0);
  }
  close_gaps(map);
  return map;
}

}  // namespace weft::pizarro
