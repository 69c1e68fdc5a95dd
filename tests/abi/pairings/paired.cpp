// SPDX-License-Identifier: Apache-2.0
// Two components that compute with floating-point numbers, remember earlier frames and draw random
// numbers: what compilers and their flags may change.
#include <Eigen/Cholesky>
#include <cmath>
#include <map>
#include <string>
#include <weft/data/matrix.hpp>
#include <weft/sdk/filter.hpp>
#include <weft/sdk/solver.hpp>

namespace {

/// Keeps what an affine map, fitted by weights, predicts. The limit follows the residuals of the
/// frames before.
struct Affine final : weft::Filter {
  static constexpr weft::About kAbout{.random = true};
  double tolerance = 2.0;

  explicit Affine(weft::Params& p) {
    p.read("tolerance", tolerance, "", {0.1, 100}, "of the usual residual");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const std::int64_t n = in.correspondences.count();
    if (n < 8) return weft::no_result("fewer than eight matches");
    weft::Rng rng = in.call.rng();
    weft::Array<double> weight({n}), residual_px({n});
    for (std::int64_t i = 0; i < n; ++i) weight(i) = rng.uniform(0.5, 1.5);
    for (int round = 0; round < 5; ++round) fit(in.correspondences, weight, residual_px);
    const double mean_px = residual_px.matrix<1>().mean();
    usual_px_ = frames_++ == 0 ? mean_px : 0.7 * usual_px_ + 0.3 * mean_px;
    const double limit_px = tolerance * usual_px_;
    weft::InlierMask mask{weft::Array<std::uint8_t>({n}), weft::Array<double>({n}), {}};
    for (std::int64_t i = 0; i < n; ++i) {
      mask.kept(i) = residual_px(i) <= limit_px ? 1 : 0;
      mask.score(i) = std::exp(-residual_px(i) / limit_px);
    }
    mask.diag.set("limit_px", limit_px);
    mask.diag.set("residual_px", residual_px);
    return mask;
  }

 private:
  /// Fits by the weights, and makes them anew of the residuals.
  static void fit(const weft::Correspondences& matches, weft::Array<double>& weight,
                  weft::Array<double>& residual_px) {
    const auto from_px = matches.template_px.matrix<2>(), to_px = matches.image_px.matrix<2>();
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
    for (std::int64_t i = 0; i < from_px.rows(); ++i) {
      const Eigen::Vector3d at(from_px(i, 0), from_px(i, 1), 1.0);
      normal += weight(i) * at * at.transpose();
      right += weight(i) * at * to_px.row(i);
    }
    const Eigen::Matrix<double, 3, 2> map = normal.llt().solve(right);
    for (std::int64_t i = 0; i < from_px.rows(); ++i) {
      const Eigen::Vector3d at(from_px(i, 0), from_px(i, 1), 1.0);
      residual_px(i) = (to_px.row(i) - at.transpose() * map).norm();
      weight(i) = 1.0 / (1.0 + residual_px(i) * residual_px(i) / 9.0);
    }
  }

  double usual_px_ = 0.0;
  std::int64_t frames_ = 0;
};

/// A rigid pose of the template by damped least squares on the kept matches, from the pose of the
/// frame before.
struct Rigid final : weft::Solver {
  static constexpr weft::About kAbout{.needs = "correspondences"};

  explicit Rigid(weft::Params&) {}

  weft::Result<weft::Shape> solve(const weft::SolverInput& in) override {
    const auto rest_m = in.templ.vertices_m.matrix<3>();
    // In a map by a text: of what standard libraries make differently.
    const auto [latest, is_first] = poses_.try_emplace("the latest pose, of whatever frame");
    Pose& pose = latest->second;
    if (is_first) pose.shift_m = Eigen::Vector3d(0, 0, 0.6) - rest_m.row(0).transpose();
    int rounds = 0;
    while (++rounds < 20 && step(in, pose) > 1e-14) {
    }
    weft::Shape shape;
    shape.vertices_m = weft::Array<double>({rest_m.rows(), 3});
    for (std::int64_t i = 0; i < rest_m.rows(); ++i) {
      shape.vertices_m.matrix<3>().row(i) = pose.of(rest_m.row(i).transpose()).transpose();
    }
    shape.source = weft::Array<std::uint8_t>({rest_m.rows()}, 1);
    shape.confidence = 0.5;
    shape.diag.set("rounds", static_cast<double>(rounds));
    return shape;
  }

 private:
  struct Pose {
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();

    Eigen::Vector3d of(const Eigen::Vector3d& point_m) const { return turn * point_m + shift_m; }
  };
  using Move = Eigen::Matrix<double, 6, 1>;

  /// The matrix by which a vector's cross product with others is taken.
  static Eigen::Matrix3d crossing(const Eigen::Vector3d& v) {
    Eigen::Matrix3d matrix;
    matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return matrix;
  }

  /// One step of Gauss and Newton; how far it went.
  static double step(const weft::SolverInput& in, Pose& pose) {
    const weft::Correspondences& matches = *in.correspondences;
    const auto rest_m = in.templ.vertices_m.matrix<3>();
    Eigen::Matrix<double, 6, 6> normal = 1e-6 * Eigen::Matrix<double, 6, 6>::Identity();
    Move right = Move::Zero();
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      if (matches.kept(i) == 0 || matches.face(i) < 0) continue;
      Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
      for (std::int64_t corner = 0; corner < 3; ++corner) {
        const std::int64_t vertex = in.templ.faces(matches.face(i), corner);
        at_m += matches.barycentrics(i, corner) * rest_m.row(vertex).transpose();
      }
      const Eigen::Vector3d seen_m = pose.of(at_m);
      const Eigen::Matrix3d by_turn = -crossing(seen_m - pose.shift_m);
      const double focal_px[] = {in.camera.fx, in.camera.fy};
      const double center_px[] = {in.camera.cx, in.camera.cy};
      for (std::int64_t axis = 0; axis < 2; ++axis) {
        const double slope = seen_m(axis) / seen_m.z();
        Eigen::RowVector3d by_point(0, 0, -slope);
        by_point(axis) = 1.0;
        by_point *= focal_px[axis] / seen_m.z();
        Move by_pose;
        by_pose << (by_point * by_turn).transpose(), by_point.transpose();
        const double off_px =
            matches.image_px(i, axis) - (focal_px[axis] * slope + center_px[axis]);
        normal += by_pose * by_pose.transpose();
        right += off_px * by_pose;
      }
    }
    const Move move = normal.llt().solve(right);
    const double angle_rad = move.head<3>().norm();
    if (angle_rad > 0.0) {  // Rodrigues
      const Eigen::Matrix3d axis = crossing(move.head<3>() / angle_rad);
      const Eigen::Matrix3d twice = axis * axis;
      pose.turn = (Eigen::Matrix3d::Identity() + std::sin(angle_rad) * axis +
                   (1.0 - std::cos(angle_rad)) * twice) *
                  pose.turn;
    }
    pose.shift_m += move.tail<3>();
    return move.norm();
  }

  std::map<std::string, Pose> poses_;
};

}  // namespace

WEFT_LIBRARY(WEFT_COMPONENT(Affine, "filters/paired.affine", "1.0.0", "Keeps an affine map."),
             WEFT_COMPONENT(Rigid, "solvers/paired.rigid", "1.0.0", "A rigid pose."))
