// SPDX-License-Identifier: Apache-2.0
#include "random_bend.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>
#include <numbers>

namespace weft::initial_guess {
namespace {

constexpr int kWaves = 4;
constexpr double kShortest = 0.5, kLongest = 2.0;  // waves, over the diagonal of the mesh

/// [V] heights over the rest mesh.
Eigen::VectorXd random_heights(const Points3& centred, Rng& rng) {
  Eigen::VectorXd heights = Eigen::VectorXd::Zero(centred.rows());
  for (int wave = 0; wave < kWaves; ++wave) {
    Eigen::Vector3d direction;
    for (double& part : direction) part = rng.normal();
    const double length = rng.uniform(kShortest, kLongest);
    const double phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
    const double amplitude = rng.normal();
    const Eigen::Vector3d per_unit = 2.0 * std::numbers::pi / length * direction.normalized();
    heights.array() += amplitude * ((centred * per_unit).array() + phase).sin();
  }
  Eigen::MatrixX4d affine(centred.rows(), 4);
  affine << Eigen::VectorXd::Ones(centred.rows()), centred;
  // A flat mesh has three of the four.
  heights -= affine * affine.completeOrthogonalDecomposition().solve(heights);
  return heights;
}

Points3 unit_normals(const Points3& vertices_m, const FacesView& faces) {
  Points3 normals = Points3::Zero(vertices_m.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::Vector3d a = vertices_m.row(faces(f, 0));
    const Eigen::Vector3d b = vertices_m.row(faces(f, 1)), c = vertices_m.row(faces(f, 2));
    for (int k = 0; k < 3; ++k) normals.row(faces(f, k)) += (b - a).cross(c - a).transpose();
  }
  for (Eigen::Index v = 0; v < normals.rows(); ++v) normals.row(v).normalize();
  return normals;
}

}  // namespace

void bend_at_random(const Points3View& rest_m, const FacesView& faces, double bend_m, Rng& rng,
                    Points3& vertices_m) {
  Points3 centred = rest_m.rowwise() - rest_m.colwise().mean();
  centred /= (centred.colwise().maxCoeff() - centred.colwise().minCoeff()).norm();
  Eigen::VectorXd heights = random_heights(centred, rng);
  const double rms = std::sqrt(heights.squaredNorm() / static_cast<double>(heights.size()));
  if (!(rms > 0.0)) return;
  heights *= bend_m / rms;
  vertices_m += heights.asDiagonal() * unit_normals(vertices_m, faces);
}

}  // namespace weft::initial_guess
