// SPDX-License-Identifier: Apache-2.0
#include "refinement.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/bspline_site.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/texture_metric.hpp>

#include "rest_metric.hpp"

namespace weft::brunet_refine {
namespace {

/// Smoothing of the fit to the vertices of the initial guess, in areas of a knot cell: they are
/// nearly on the spline.
constexpr double kStartSmoothing = 1e-3;

/// Checks before each evaluation whether the host cancelled, and keeps the exception from passing
/// through Ceres.
class Patience final : public ceres::EvaluationCallback, public ceres::IterationCallback {
 public:
  explicit Patience(std::int64_t passes) : passes_(passes) {}

  void PrepareForEvaluation(bool jacobians, bool /*new_point*/) override {
    if (stopped_) return;
    try {
      worked(jacobians ? 300 * passes_ : 20 * passes_);  // with the step that follows
    } catch (const Stopped&) {
      stopped_ = true;
    }
  }
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return stopped_ ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }
  bool stopped() const { return stopped_; }

 private:
  std::int64_t passes_;
  bool stopped_ = false;
};

ceres::Solver::Options solver_options(const FitOptions& options, Patience& patience) {
  ceres::Solver::Options chosen;
  chosen.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // Not SuiteSparse: its kernels may use threads, and sum in another order on another machine.
  chosen.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  chosen.num_threads = 1;
  chosen.logging_type = ceres::SILENT;
  chosen.max_num_iterations = options.max_iterations;
  chosen.function_tolerance = options.tolerance;
  chosen.parameter_tolerance = 1e-9;
  chosen.callbacks = {&patience};
  return chosen;
}

}  // namespace

Result<void> SplineRefinement::set_template(const Template& templ, const SurfaceOptions& options) {
  const auto vertices_m = templ.vertices_m.matrix<3>();
  const auto flat_px = templ.flat_px.matrix<2>();
  const auto faces = templ.faces.matrix<3>();
  if (auto valid = validate_mesh(vertices_m, faces); !valid) return valid.error();
  if (auto valid = validate_flat_mesh(flat_px, faces); !valid) return valid.error();
  domain_ = domain_around(templ, options.control);
  const auto places = metric_places(templ, domain_, options.places_per_cell);
  if (!places) return places.error();
  if (places->empty()) return Error{Errc::invalid_data, "the mesh is too small in its texture"};
  options_ = options;
  flat_px_ = flat_px;
  start_equations_.set_domain(domain_);
  metric_.clear();
  metric_corners_.clear();
  const double scale = 0.5 / (options.strain * std::sqrt(static_cast<double>(places->size())));
  for (const MetricPlace& place : *places) {
    metric_.emplace_back(place.first, place.second, scale);
    metric_corners_.push_back(place.corner);
  }
  const Eigen::Vector2d m_per_px = texel_pitch(vertices_m, flat_px, faces).m_per_px;
  bending_.clear();
  bending_.emplace_back(m_per_px.x() * domain_.su(), m_per_px.y() * domain_.sv(),
                        std::sqrt(options.smoothing));
  return {};
}

/// The spline through the start's vertices.
Result<void> SplineRefinement::place_control(const Points3View& start_m) {
  start_equations_.clear(3);
  for (Eigen::Index v = 0; v < start_m.rows(); ++v) {
    start_equations_.add(spline_site(domain_, flat_px_(v, 0), flat_px_(v, 1)), start_m.row(v));
  }
  auto control = start_equations_.solve(kStartSmoothing * domain_.su() * domain_.sv());
  if (!control) return control.error();
  control_ = *std::move(control);
  return {};
}

void SplineRefinement::load_points(std::span<const solvers::SeenPoint> points, const Camera& camera,
                                   double noise_px) {
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  seen_.clear();
  seen_corners_.clear();
  for (const solvers::SeenPoint& point : points) {
    Eigen::RowVector2d place_px = Eigen::RowVector2d::Zero();
    for (int k = 0; k < 3; ++k) {
      place_px += point.weights[k] * flat_px_.row(point.corners[to_index(k)]);
    }
    const SplineSite site = spline_site(domain_, place_px.x(), place_px.y());
    seen_.emplace_back(site.weights, pinhole, point.seen_px, noise_px);
    seen_corners_.push_back(domain_.control_index(site.i, site.j));
  }
}

/// Ceres complains aloud about a start without residuals.
bool SplineRefinement::starts_in_front() {
  Eigen::Vector2d off;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const auto blocks = blocks_from(seen_corners_[i]);
    if (!seen_[i].Evaluate(blocks.data(), off.data(), nullptr) || !off.allFinite()) return false;
  }
  return true;
}

std::vector<double*> SplineRefinement::blocks_from(Eigen::Index corner) {
  std::vector<double*> blocks;
  for (Eigen::Index k = 0; k < 4; ++k) {
    for (Eigen::Index l = 0; l < 4; ++l) {
      blocks.push_back(control_.row(corner + k * domain_.nv + l).data());
    }
  }
  return blocks;
}

Points3 SplineRefinement::vertices_m() const {
  Points3 vertices_m(flat_px_.rows(), 3);
  for (Eigen::Index v = 0; v < flat_px_.rows(); ++v) {
    const SplineSite site = spline_site(domain_, flat_px_(v, 0), flat_px_(v, 1));
    vertices_m.row(v) = evaluate_site(domain_, site, control_).transpose();
  }
  return vertices_m;
}

double SplineRefinement::metric_rms() {
  double sum = 0.0;
  Eigen::Vector3d off;
  for (std::size_t g = 0; g < metric_.size(); ++g) {
    metric_[g].Evaluate(blocks_from(metric_corners_[g]).data(), off.data(), nullptr);
    sum += off.squaredNorm();
  }
  return 2.0 * options_.strain * std::sqrt(sum);
}

Result<RefinedSurface> SplineRefinement::refine(std::span<const solvers::SeenPoint> points,
                                                const Camera& camera, const Points3View& start_m,
                                                const FitOptions& options) {
  if (auto placed = place_control(start_m); !placed) return placed.error();
  load_points(points, camera, options.match_noise_px);
  if (!starts_in_front()) return no_result("the start is not in front of the camera");

  Patience patience(static_cast<std::int64_t>(seen_.size() + metric_.size()));
  ceres::HuberLoss huber(options.outlier_px / options.match_noise_px);
  ceres::ScaledLoss of_match(&huber, 1.0 / static_cast<double>(points.size()),
                             ceres::DO_NOT_TAKE_OWNERSHIP);
  ceres::Problem::Options owned_here;
  owned_here.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  owned_here.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  owned_here.evaluation_callback = &patience;
  ceres::Problem problem(owned_here);
  // In their order, so that the unknowns have the same order in all frames.
  for (Eigen::Index c = 0; c < control_.rows(); ++c) {
    problem.AddParameterBlock(control_.row(c).data(), 3);
  }
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    problem.AddResidualBlock(&seen_[i], &of_match, blocks_from(seen_corners_[i]));
  }
  for (std::size_t g = 0; g < metric_.size(); ++g) {
    problem.AddResidualBlock(&metric_[g], nullptr, blocks_from(metric_corners_[g]));
  }
  for (std::int32_t i = 0; i + 4 <= domain_.nu; ++i) {
    for (std::int32_t j = 0; j + 4 <= domain_.nv; ++j) {
      problem.AddResidualBlock(&bending_.front(), nullptr,
                               blocks_from(domain_.control_index(i, j)));
    }
  }

  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(options, patience), &problem, &summary);
  if (patience.stopped()) throw Stopped{};
  RefinedSurface refined;
  if (!summary.IsSolutionUsable()) return no_result("not refined: " + summary.message);
  refined.energy.push_back(2.0 * summary.initial_cost);  // Ceres halves it
  for (const ceres::IterationSummary& step : summary.iterations) {
    const bool lowered = step.iteration > 0 && step.step_is_successful;
    if (lowered) refined.energy.push_back(2.0 * step.cost);
  }
  refined.iterations = static_cast<int>(summary.iterations.size()) - 1;
  refined.converged = summary.termination_type == ceres::CONVERGENCE;
  refined.vertices_m = vertices_m();
  refined.metric_rms = metric_rms();
  return refined;
}

}  // namespace weft::brunet_refine
