// SPDX-License-Identifier: Apache-2.0
#include "common/laplacian/seen_matches.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {
namespace {

Error mistake(std::int64_t i, const std::string& problem) {
  return {Errc::invalid_data, "match " + std::to_string(i) + " " + problem};
}

Result<void> check_match(const Correspondences& matches, std::int64_t i, Eigen::Index face_count) {
  if (matches.face(i) >= face_count) {
    return mistake(i, "lies in face " + std::to_string(matches.face(i)) + " of a template with " +
                          std::to_string(face_count) + ": use one template throughout");
  }
  const double* weights = matches.barycentrics.row(i);
  const double sum =
      weights[0] + weights[1] + weights[2] + matches.image_px(i, 0) + matches.image_px(i, 1);
  if (!std::isfinite(sum)) return mistake(i, "is not finite: leave it out");
  return {};
}

}  // namespace

Result<SeenMatches> read_matches(const Correspondences& matches, const Pinhole& camera,
                                 const ControlMesh& mesh) {
  SeenMatches seen;
  seen.camera = camera;
  seen.record_count = matches.count();
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) == 0 || matches.face(i) < 0) continue;
    if (auto checked = check_match(matches, i, mesh.faces.rows()); !checked) {
      return checked.error();
    }
    seen.places.push_back(i);
    seen.faces.push_back(matches.face(i));
  }
  const auto count = static_cast<Eigen::Index>(seen.faces.size());
  seen.weights = Eigen::MatrixXd::Zero(count, mesh.control_count());
  seen.seen_px.resize(count, 2);
  seen.slopes.resize(count, 2);
  for (Eigen::Index m = 0; m < count; ++m) {
    worked(mesh.control_count());
    const std::int64_t i = seen.places[to_index(m)];
    for (int k = 0; k < 3; ++k) {
      seen.weights.row(m) +=
          matches.barycentrics(i, k) * mesh.weights.row(mesh.faces(matches.face(i), k));
    }
    seen.seen_px.row(m) << matches.image_px(i, 0), matches.image_px(i, 1);
    seen.slopes.row(m) << (seen.seen_px(m, 0) - camera.cx) / camera.fx,
        (seen.seen_px(m, 1) - camera.cy) / camera.fy;
  }
  return seen;
}

Eigen::MatrixXd reprojection_matrix(const SeenMatches& matches, const Eigen::VectorXd& counts) {
  const Eigen::Index n = matches.weights.cols();
  const Eigen::VectorXd a = matches.slopes.col(0), b = matches.slopes.col(1);
  const auto gram = [&](const Eigen::VectorXd& factors) -> Eigen::MatrixXd {
    ask_to_go_on();
    return matches.weights.transpose() * factors.cwiseProduct(counts).asDiagonal() *
           matches.weights;
  };
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  matrix.block(0, 0, n, n) = matrix.block(n, n, n, n) = gram(Eigen::VectorXd::Ones(a.rows()));
  matrix.block(0, 2 * n, n, n) = matrix.block(2 * n, 0, n, n) = -gram(a);
  matrix.block(n, 2 * n, n, n) = matrix.block(2 * n, n, n, n) = -gram(b);
  matrix.block(2 * n, 2 * n, n, n) = gram(a.cwiseAbs2() + b.cwiseAbs2());
  return matrix;
}

Eigen::VectorXd distances_px(const SeenMatches& matches, const Eigen::MatrixX3d& controls_m) {
  const Points3 points_m = matches.weights * controls_m;
  Eigen::VectorXd distances(matches.count());
  for (Eigen::Index m = 0; m < matches.count(); ++m) {
    const double off_px =
        (project(matches.camera, points_m.row(m)) - matches.seen_px.row(m).transpose()).norm();
    distances[m] = std::isfinite(off_px) ? off_px : std::numeric_limits<double>::infinity();
  }
  return distances;
}

void add_for_each_axis(const Eigen::MatrixXd& matrix, double factor, Eigen::MatrixXd& sum) {
  const Eigen::Index n = matrix.rows();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    sum.block(axis * n, axis * n, n, n) += factor * matrix;
  }
}

bool on_a_line(const Eigen::MatrixXd& points) {
  constexpr double kFlattest = 1e-3;
  if (points.rows() < 3) return true;
  const Eigen::MatrixXd centred = points.rowwise() - points.colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spread(centred.transpose() * centred,
                                                              Eigen::EigenvaluesOnly);
  const Eigen::Index last = points.cols() - 1;
  const Eigen::VectorXd& widths = spread.eigenvalues();
  return !(widths[last - 1] > kFlattest * kFlattest * widths[last]);
}

}  // namespace weft::solvers
