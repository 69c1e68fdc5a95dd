// SPDX-License-Identifier: Apache-2.0
#include "frontal_guess.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>

namespace weft::gauss_newton {
namespace {

constexpr int kRounds = 20;
constexpr double kLeastDistancePx = 0.5;  // least distance in a weight; nearer ones count alike
constexpr double kFlattest = 1e-3;        // least spread of the observations over the largest

/// x, y and front of the plane of a mesh, as rows, right-handed.
Eigen::Matrix3d plane_of(const MeshModel& mesh) {
  const Points3 centred_m = mesh.rest_m.rowwise() - mesh.rest_m.colwise().mean();
  Points3 normals(mesh.faces.rows(), 3);
  face_normals(mesh.rest_m, mesh.faces, normals);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(centred_m.transpose() * centred_m);
  Eigen::Vector3d front = axes.eigenvectors().col(0);
  if (normals.colwise().sum().dot(front) < 0.0) front = -front;
  Eigen::Matrix3d plane;
  plane.row(0) = axes.eigenvectors().col(2).transpose();
  plane.row(2) = front.transpose();
  plane.row(1) = front.cross(axes.eigenvectors().col(2)).transpose();
  return plane;
}

}  // namespace

std::optional<Points3> frontal_guess(const FrameData& frame, const MeshModel& mesh) {
  const Eigen::Matrix3d plane = plane_of(mesh);
  const Eigen::RowVector3d middle_m = mesh.rest_m.colwise().mean();
  const auto count = static_cast<Eigen::Index>(frame.observations.size());
  Eigen::MatrixX3d places(count, 3);  // x, y in the plane and 1
  Points2 pixels(count, 2);
  for (const SeenFace& seen : frame.faces) {
    for (std::size_t i = seen.first; i < seen.end; ++i) {
      const Observation& o = frame.observations[i];
      Eigen::RowVector3d rest_m = -middle_m;
      for (std::size_t k = 0; k < 3; ++k) {
        rest_m += o.weights[k] * mesh.rest_m.row(mesh.faces(seen.face, static_cast<int>(k)));
      }
      const auto row = static_cast<Eigen::Index>(i);
      places.row(row) << rest_m * plane.topRows<2>().transpose(), 1.0;
      pixels.row(row) << o.seen_px[0], o.seen_px[1];
    }
  }
  const Points2 spread = places.leftCols<2>().rowwise() - places.leftCols<2>().colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> widths(spread.transpose() * spread);
  if (!(widths.eigenvalues()[0] > kFlattest * kFlattest * widths.eigenvalues()[1])) return {};
  Eigen::Matrix<double, 3, 2> affine;
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(count);
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::MatrixX3d weighted = weights.asDiagonal() * places;
    affine = (places.transpose() * weighted).ldlt().solve(weighted.transpose() * pixels);
    const Eigen::VectorXd distances_px = (places * affine - pixels).rowwise().norm();
    weights = distances_px.cwiseMax(kLeastDistancePx).cwiseInverse();
  }
  if (!affine.allFinite()) return {};
  // y of the image runs down and the front looks at the camera: x, y, front become x, -y, -z
  // turned.
  const Eigen::Matrix2d slope = affine.topRows<2>().transpose();
  if (!(slope.determinant() < 0.0)) return {};
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(slope, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double px_per_m = svd.singularValues()[0];  // a tilt only shortens
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  turn.topLeftCorner<2, 2>() = svd.matrixU() * svd.matrixV().transpose();
  turn(2, 2) = -1.0;
  const Pinhole& camera = frame.camera;
  const double depth_m = std::sqrt(camera.fx * camera.fy) / px_per_m;
  const Eigen::Vector3d place_m(depth_m * (affine(2, 0) - camera.cx) / camera.fx,
                                depth_m * (affine(2, 1) - camera.cy) / camera.fy, depth_m);
  const Eigen::Matrix3d rotation = turn * plane;
  Points3 start_m = (mesh.rest_m.rowwise() - middle_m) * rotation.transpose();
  start_m.rowwise() += place_m.transpose();
  if (!start_m.allFinite()) return {};
  return start_m;
}

}  // namespace weft::gauss_newton
