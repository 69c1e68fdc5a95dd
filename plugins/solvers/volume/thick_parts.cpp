// SPDX-License-Identifier: Apache-2.0
#include "thick_parts.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::volume {
namespace {

struct Ball {
  Eigen::Vector3d centre_m;
  double radius_m = 0.0;
};

/// Centres of the faces and their outer normals.
struct Samples {
  std::vector<Eigen::Vector3d> place_m, normal;

  explicit Samples(const SolidModel& body) {
    for (Eigen::Index f = 0; f < body.faces().rows(); ++f) {
      const Eigen::Vector3d a = body.vertices_m().row(body.faces()(f, 0)),
                            b = body.vertices_m().row(body.faces()(f, 1)),
                            c = body.vertices_m().row(body.faces()(f, 2));
      place_m.emplace_back((a + b + c) / 3.0);
      normal.push_back((b - a).cross(c - a).normalized());
    }
  }
};

std::vector<Ball> touching_balls(const Samples& samples) {
  constexpr double kAcross = -0.5;  // cosine between the two places, from the centre
  std::vector<Ball> balls;
  for (std::size_t i = 0; i < samples.place_m.size(); ++i) {
    worked(static_cast<std::int64_t>(samples.place_m.size()) / 8);
    double radius_m = std::numeric_limits<double>::infinity();
    std::size_t touched = i;
    for (std::size_t j = 0; j < samples.place_m.size(); ++j) {
      const Eigen::Vector3d off_m = samples.place_m[j] - samples.place_m[i];
      const double inwards_m = -off_m.dot(samples.normal[i]);
      if (!(inwards_m > 1e-3 * off_m.norm())) continue;
      const double own_m = 0.5 * off_m.squaredNorm() / inwards_m;
      if (own_m >= radius_m) continue;
      radius_m = own_m;
      touched = j;
    }
    const Eigen::Vector3d centre_m = samples.place_m[i] - radius_m * samples.normal[i];
    const double across = samples.normal[i].dot(samples.place_m[touched] - centre_m);
    if (touched != i && across < kAcross * radius_m) balls.push_back({centre_m, radius_m});
  }
  return balls;
}

/// The balls that stand for the thickness around them, from the largest.
std::vector<Ball> chosen(std::vector<Ball> balls) {
  constexpr double kLeast = 0.7;  // share of the radius of any ball that holds the centre
  constexpr double kApart = 0.5;  // distance between centres, in radii
  std::stable_sort(balls.begin(), balls.end(),
                   [](const Ball& a, const Ball& b) { return a.radius_m > b.radius_m; });
  std::vector<Ball> kept;
  for (const Ball& ball : balls) {
    const bool stands = std::none_of(kept.begin(), kept.end(), [&](const Ball& other) {
      const double distance_m = (other.centre_m - ball.centre_m).norm();
      return distance_m < kApart * other.radius_m ||
             (distance_m < other.radius_m && ball.radius_m < kLeast * other.radius_m);
    });
    if (stands) kept.push_back(ball);
  }
  return kept;
}

/// A quarter of a tetrahedron: F is constant in it.
struct Quarter {
  std::size_t tetrahedron;
  Eigen::Vector3d place_m;
  double weight;
};

std::vector<Quarter> quarters_in(const SolidModel& body, const Ball& ball, double radius_m) {
  std::vector<Quarter> found;
  for (std::size_t e = 0; e < body.tetrahedra().size(); ++e) {
    const Tetrahedron& each = body.tetrahedra()[e];
    Eigen::Matrix<double, 3, 4> corners;
    for (int a = 0; a < 4; ++a) {
      corners.col(a) = body.nodes_m().row(each.node[to_index(a)]).transpose();
    }
    const Eigen::Vector3d centre_m = corners.rowwise().mean();
    for (int a = 0; a < 4; ++a) {
      const Eigen::Vector3d place_m = 0.5 * (centre_m + corners.col(a));
      if ((place_m - ball.centre_m).norm() < radius_m) {
        found.push_back({e, place_m, each.share});
      }
    }
  }
  return found;
}

/// Weights 1 + l . (place - centre) with the least l that moves the mean place to the centre.
void balance(const Ball& ball, std::vector<Quarter>& quarters) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const Quarter& each : quarters) {
    const Eigen::Vector3d off_m = each.place_m - ball.centre_m;
    sum += each.weight * off_m;
    squares += each.weight * off_m * off_m.transpose();
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> solver(squares);
  if (!solver.isInvertible()) return;
  const Eigen::Vector3d tilt = -solver.solve(sum);
  for (Quarter& each : quarters) {
    each.weight *= std::max(0.0, 1.0 + tilt.dot(each.place_m - ball.centre_m));
  }
}

/// The nodes of quarters of tetrahedra in ascending order.
std::vector<std::int32_t> nodes_of(const SolidModel& body, const std::vector<Quarter>& quarters) {
  std::set<std::int32_t> nodes;
  for (const Quarter& each : quarters) {
    const auto& of = body.tetrahedra()[each.tetrahedron].node;
    nodes.insert(of.begin(), of.end());
  }
  return {nodes.begin(), nodes.end()};
}

/// The gradients in the quarters, one axis after the other, as a matrix [3 q, n] on the nodes.
Eigen::MatrixXd gradients_of(const SolidModel& body, const std::vector<Quarter>& quarters,
                             const std::vector<std::int32_t>& nodes) {
  const auto count = static_cast<Eigen::Index>(quarters.size());
  Eigen::MatrixXd gradients =
      Eigen::MatrixXd::Zero(3 * count, static_cast<Eigen::Index>(nodes.size()));
  for (Eigen::Index q = 0; q < count; ++q) {
    const Tetrahedron& in = body.tetrahedra()[quarters[to_index(q)].tetrahedron];
    for (std::size_t a = 0; a < 4; ++a) {
      const auto column = std::lower_bound(nodes.begin(), nodes.end(), in.node[a]) - nodes.begin();
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        gradients(axis * count + q, column) += in.slopes(axis, static_cast<Eigen::Index>(a));
      }
    }
  }
  return gradients;
}

Eigen::VectorXd weights_of(const std::vector<Quarter>& quarters) {
  Eigen::VectorXd weights(static_cast<Eigen::Index>(quarters.size()));
  for (std::size_t q = 0; q < quarters.size(); ++q) {
    weights[static_cast<Eigen::Index>(q)] = quarters[q].weight;
  }
  return weights / weights.sum();
}

/// (I - B B^+) / (n r^2) with the monomials up to the second degree of the places of the nodes,
/// from the centre in radii, in the rows of B [n,10].
Eigen::MatrixXd unevenness_of(const SolidModel& body, const Ball& ball,
                              const std::vector<std::int32_t>& nodes) {
  const auto count = static_cast<Eigen::Index>(nodes.size());
  Eigen::Matrix<double, Eigen::Dynamic, 10> monomials(count, 10);
  for (Eigen::Index a = 0; a < count; ++a) {
    const Eigen::Vector3d p =
        (body.nodes_m().row(nodes[to_index(a)]).transpose() - ball.centre_m) / ball.radius_m;
    monomials.row(a) << 1.0, p.x(), p.y(), p.z(), p.x() * p.x(), p.y() * p.y(), p.z() * p.z(),
        p.x() * p.y(), p.y() * p.z(), p.z() * p.x();
  }
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse(monomials);
  const Eigen::MatrixXd left =
      Eigen::MatrixXd::Identity(count, count) - monomials * inverse.pseudoInverse();
  return left / (static_cast<double>(count) * ball.radius_m * ball.radius_m);
}

/// Empty where the lattice is too coarse for the ball.
ThickPart part_of(const SolidModel& body, const Ball& ball) {
  constexpr std::size_t kFewestQuarters = 16;
  constexpr double kWider = 1.4;
  std::vector<Quarter> inner = quarters_in(body, ball, ball.radius_m);
  if (inner.size() < kFewestQuarters) return {};
  balance(ball, inner);
  const std::vector<Quarter> wider = quarters_in(body, ball, kWider * ball.radius_m);
  ThickPart part;
  part.node = nodes_of(body, wider);
  part.share = ball.radius_m * ball.radius_m * ball.radius_m;
  const Eigen::MatrixXd gradients = gradients_of(body, inner, part.node);
  const Eigen::VectorXd weights = weights_of(inner);
  const auto count = static_cast<Eigen::Index>(inner.size());
  part.slopes.resize(3, gradients.cols());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    part.slopes.row(axis) = weights.transpose() * gradients.middleRows(axis * count, count);
  }
  const Eigen::MatrixXd form = unevenness_of(body, ball, part.node);
  for (Eigen::Index a = 0; a < form.rows(); ++a) {
    for (Eigen::Index b = a; b < form.cols(); ++b)
      part.unevenness.push_back(0.5 * (form(a, b) + form(b, a)));
  }
  return part;
}

}  // namespace

std::vector<ThickPart> thick_parts(const SolidModel& body) {
  std::vector<ThickPart> parts;
  double shares = 0.0;
  for (const Ball& ball : chosen(touching_balls(Samples(body)))) {
    ThickPart part = part_of(body, ball);
    if (part.node.empty()) continue;
    shares += part.share;
    parts.push_back(std::move(part));
  }
  for (ThickPart& part : parts) part.share /= shares;
  return parts;
}

}  // namespace weft::volume
