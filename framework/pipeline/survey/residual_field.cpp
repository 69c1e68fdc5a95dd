// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/residual_field.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/bspline_bending.hpp>
#include <weft/geometry/bspline_site.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/texture_metric.hpp>

namespace weft {
namespace {

constexpr Eigen::Index kFewestResiduals = 60;

/// d(pixel)/d(point) of a pinhole camera.
Eigen::Matrix<double, 2, 3> image_jacobian(const Camera& camera, const Eigen::Vector3d& at) {
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << camera.fx / at.z(), 0.0, -camera.fx * at.x() / (at.z() * at.z()),  //
      0.0, camera.fy / at.z(), -camera.fy * at.y() / (at.z() * at.z());
  return jacobian;
}

/// A field fitted to residuals with one weight of its bending energy.
class FieldFit {
 public:
  FieldFit(const SplineDomain& domain, const TextureResiduals& residuals)
      : off_px_(residuals.off_px),
        rows_(residuals.at_px.rows(), domain.control_count()),
        bending_(bending_matrix(domain)) {
    rows_.setZero();
    for (Eigen::Index i = 0; i < rows_.rows(); ++i) {
      const SplineSite site = spline_site(domain, residuals.at_px(i, 0), residuals.at_px(i, 1));
      for (int k = 0; k < 16; ++k) {
        rows_(i, domain.control_index(site.i + k / 4, site.j + k % 4)) = site.weights[to_index(k)];
      }
    }
  }

  /// Normal equations without bending energy; those of two sets of weights add up.
  struct Equations {
    Eigen::MatrixXd normal;
    Eigen::MatrixXd right;
  };
  Equations equations(const Eigen::VectorXd& weights) const {
    const Eigen::MatrixXd weighted = weights.asDiagonal() * rows_;
    return {weighted.transpose() * rows_, weighted.transpose() * off_px_};
  }

  /// The control points that solve them.
  Points2 control(const Equations& equations, double smoothing) const {
    Eigen::MatrixXd normal = equations.normal;
    const double scale = normal.trace() / bending_.trace();
    normal += smoothing * scale * bending_;
    normal.diagonal().array() += 1e-9 * normal.trace() / static_cast<double>(normal.rows());
    return normal.ldlt().solve(equations.right);
  }

  /// Residuals after fields with these control points.
  Points2 left(const Points2& control_px) const { return off_px_ - rows_ * control_px; }

 private:
  Points2 off_px_;
  Eigen::MatrixXd rows_;
  Eigen::MatrixXd bending_;
};

/// Geman-McClure's weights, of a scale that follows from what is left.
Eigen::VectorXd robust_weights(const Points2& left_px) {
  constexpr double kLeast_px = 0.5, kScale = 3.0;
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < left_px.rows(); ++i) distances.push_back(left_px.row(i).norm());
  const double scale = std::max(kLeast_px, kScale * median(distances));
  return (1.0 + left_px.rowwise().squaredNorm().array() / (scale * scale)).square().inverse();
}

double weighted_squares(const Eigen::VectorXd& weights, const Points2& left_px) {
  return weights.dot(left_px.rowwise().squaredNorm());
}

/// Residuals in two folds.
class Folds {
 public:
  Folds(const FieldFit& fit, const Eigen::VectorXd& weights) : fit_(fit) {
    for (const Eigen::Index fold : {0, 1}) {
      Eigen::VectorXd own = weights;
      for (Eigen::Index i = fold; i < own.size(); i += 2) own(i) = 0.0;
      others_.push_back(weights - own);
      equations_.push_back(fit.equations(own));
    }
  }

  Points2 control(double smoothing) const {
    return fit_.control(
        {equations_[0].normal + equations_[1].normal, equations_[0].right + equations_[1].right},
        smoothing);
  }

  /// Squares of residuals that fields through the others leave.
  double left_out_squares(double smoothing) const {
    double sum = 0.0;
    for (const std::size_t fold : {0U, 1U}) {
      const Points2 left_px = fit_.left(fit_.control(equations_[fold], smoothing));
      sum += weighted_squares(others_[fold], left_px);
    }
    return sum;
  }

 private:
  const FieldFit& fit_;
  std::vector<Eigen::VectorXd> others_;  ///< weights of the omitted ones
  std::vector<FieldFit::Equations> equations_;
};

SplineDomain domain_over(const Template& templ) {
  constexpr double kKnots = 8.0;  // along the longer side
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const Eigen::RowVector2d low = flat_px.colwise().minCoeff(), high = flat_px.colwise().maxCoeff();
  const Eigen::RowVector2d size = (high - low).cwiseMax(1.0);
  const auto controls = [&](double side) {
    return 3 + std::max(1, static_cast<int>(std::lround(kKnots * side / size.maxCoeff())));
  };
  return {low.x(),           low.x() + size.x(), low.y(), low.y() + size.y(), controls(size.x()),
          controls(size.y())};
}

}  // namespace

TextureResiduals texture_residuals(const Template& templ, const Camera& camera,
                                   const Correspondences& matches,
                                   const RigidAlignment& camera_from_template) {
  constexpr double kFlattest =
      0.2;  // ratio of the axes of a circle on the surface, as the camera sees it
  const Points3 vertices_m = transform_points(camera_from_template, templ.vertices_m.matrix<3>());
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const Faces faces = templ.faces.matrix<3>();
  const auto locator = FaceLocator::create(flat_px, faces);
  std::vector<Eigen::RowVector4d> found;
  for (std::int64_t i = 0; locator && i < matches.count(); ++i) {
    if (matches.kept(i) == 0) continue;
    const Eigen::Vector2d shown_px(matches.template_px(i, 0), matches.template_px(i, 1));
    const FaceLocation on = locator->locate(shown_px);
    if (on.face < 0) continue;
    const Eigen::Vector3d at = interpolate(vertices_m, faces, on.face, on.weights);
    if (!(at.z() > 0.0)) continue;
    const Eigen::Matrix2d by_texture =
        image_jacobian(camera, at) * texture_jacobian(vertices_m, flat_px, faces, on.face);
    const Eigen::Vector2d sizes = by_texture.jacobiSvd().singularValues();
    if (!(sizes(1) > kFlattest * sizes(0))) continue;
    const Eigen::Vector2d expected_px =
        project(Pinhole{camera.fx, camera.fy, camera.cx, camera.cy}, at);
    const Eigen::Vector2d seen_px(matches.image_px(i, 0), matches.image_px(i, 1));
    const Eigen::Vector2d by_px = by_texture.inverse() * (seen_px - expected_px);
    const Eigen::Vector2d at_px = shown_px + by_px;
    found.emplace_back(at_px.x(), at_px.y(), -by_px.x(), -by_px.y());
  }
  TextureResiduals residuals{Points2(static_cast<Eigen::Index>(found.size()), 2),
                             Points2(static_cast<Eigen::Index>(found.size()), 2)};
  for (std::size_t i = 0; i < found.size(); ++i) {
    residuals.at_px.row(static_cast<Eigen::Index>(i)) = found[i].head<2>();
    residuals.off_px.row(static_cast<Eigen::Index>(i)) = found[i].tail<2>();
  }
  return residuals;
}

TextureResiduals joined(const TextureResiduals& a, const TextureResiduals& b) {
  TextureResiduals both{Points2(a.at_px.rows() + b.at_px.rows(), 2),
                        Points2(a.at_px.rows() + b.at_px.rows(), 2)};
  both.at_px << a.at_px, b.at_px;
  both.off_px << a.off_px, b.off_px;
  return both;
}

Eigen::Vector2d ResidualField::operator()(const Eigen::Vector2d& at_px) const {
  return evaluate_site(domain, spline_site(domain, at_px.x(), at_px.y()), control_px);
}

bool ResidualField::is_coherent() const {
  constexpr double kLeast_px = 1.0, kLeastPredicted = 0.3;
  return rms_px >= kLeast_px && predicted >= kLeastPredicted;
}

std::optional<ResidualField> fit_residual_field(const Template& templ,
                                                const TextureResiduals& residuals) {
  if (residuals.at_px.rows() < kFewestResiduals) return std::nullopt;
  constexpr int kRounds = 8;
  ResidualField field;
  field.domain = domain_over(templ);
  field.matches = residuals.at_px.rows();
  const FieldFit fit(field.domain, residuals);
  Eigen::VectorXd weights = robust_weights(residuals.off_px);
  for (int round = 0; round < kRounds; ++round) {
    const Folds folds(fit, weights);
    double least = std::numeric_limits<double>::infinity(), best = 1.0;
    for (const double smoothing : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0}) {
      const double squares = folds.left_out_squares(smoothing);
      if (squares < least) best = smoothing;
      least = std::min(least, squares);
    }
    field.control_px = folds.control(best);
    field.predicted = 1.0 - least / weighted_squares(weights, residuals.off_px);
    weights = robust_weights(fit.left(field.control_px));
  }
  double squares = 0.0;
  for (Eigen::Index i = 0; i < residuals.at_px.rows(); ++i) {
    const Eigen::Vector2d by_px = field(residuals.at_px.row(i));
    squares += weights(i) * by_px.squaredNorm();
    if (weights(i) < 0.25 || by_px.norm() <= field.most_px) continue;
    field.most_px = by_px.norm();
    field.most_at_px = residuals.at_px.row(i);
  }
  field.rms_px = std::sqrt(squares / weights.sum());
  field.noise_px = std::sqrt(weighted_squares(weights, fit.left(field.control_px)) / weights.sum());
  return field;
}

Template corrected(const Template& templ, const ResidualField& field) {
  Template result = templ;
  const Eigen::Array2d most(static_cast<double>(templ.texture.dim(1)) - 0.5,
                            static_cast<double>(templ.texture.dim(0)) - 0.5);
  result.flat_px = Array<double>({templ.flat_px.rows(), 2});
  for (std::int64_t v = 0; v < templ.flat_px.rows(); ++v) {
    const Eigen::Vector2d at(templ.flat_px(v, 0), templ.flat_px(v, 1));
    const Eigen::Array2d to = (at + field(at)).array().max(-0.5).min(most);
    result.flat_px(v, 0) = to.x();
    result.flat_px(v, 1) = to.y();
  }
  return result;
}

}  // namespace weft
