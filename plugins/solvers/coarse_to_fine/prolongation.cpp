// SPDX-License-Identifier: Apache-2.0
#include "prolongation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/mesh_adjacency.hpp>

namespace weft::coarse_to_fine {
namespace {

constexpr int kRings = 2;
constexpr Eigen::Index kEnoughForQuadratics = 10;
constexpr double kSumOff = 1e-6;    // weights of a spline that could not be solved for
constexpr double kNoDetail = 1e-9;  // share of the size at rest

/// The coarse vertices within two rings of a face, ascending.
std::vector<std::int32_t> around_face(const Faces& faces, const IndexLists& faces_of,
                                      std::int32_t face) {
  std::vector<std::int32_t> found{faces(face, 0), faces(face, 1), faces(face, 2)};
  for (int ring = 0; ring < kRings; ++ring) {
    const std::vector<std::int32_t> before = found;
    for (const std::int32_t v : before) {
      for (const std::int32_t f : faces_of[v]) {
        for (Eigen::Index k = 0; k < 3; ++k) found.push_back(faces(f, k));
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
  }
  return found;
}

/// Weights of the values at some centres in the polyharmonic spline through them.
class LocalSpline {
 public:
  explicit LocalSpline(const Points2& places) {
    centre_ = places.colwise().mean();
    scale_ = std::sqrt((places.rowwise() - centre_).rowwise().squaredNorm().mean());
    centres_ = (places.rowwise() - centre_) / scale_;
    const Eigen::Index n = places.rows();
    is_quadratic_ = n >= kEnoughForQuadratics;
    const Eigen::Index terms = is_quadratic_ ? 6 : 3;
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + terms, n + terms);
    for (Eigen::Index k = 0; k < n; ++k) system.col(k) = values_at(centres_.row(k));
    system.topRightCorner(n, terms) = system.bottomLeftCorner(terms, n).transpose();
    solver_.compute(system);
  }

  /// [n], empty where the centres determine no spline.
  Eigen::VectorXd weights_at(const Eigen::RowVector2d& place) const {
    const Eigen::RowVector2d q = (place - centre_) / scale_;
    const Eigen::VectorXd weights = solver_.solve(values_at(q)).head(centres_.rows());
    const bool is_sound = weights.allFinite() && std::abs(weights.sum() - 1.0) < kSumOff &&
                          (weights.transpose() * centres_ - q).cwiseAbs().maxCoeff() < kSumOff;
    return is_sound ? weights : Eigen::VectorXd();
  }

 private:
  /// The kernel to each centre, then the polynomials.
  Eigen::VectorXd values_at(const Eigen::RowVector2d& q) const {
    constexpr double kTiny = 1e-300;  // keeps the logarithm of 0 finite
    const Eigen::Index n = centres_.rows();
    Eigen::VectorXd values(n + (is_quadratic_ ? 6 : 3));
    const Eigen::ArrayXd r2 = (centres_.rowwise() - q).rowwise().squaredNorm();
    values.head(n) = r2 * r2.max(kTiny).log();
    values.segment<3>(n) << 1.0, q.transpose();
    if (!is_quadratic_) return values;
    values.head(n).array() *= r2;
    values.tail<3>() << q.x() * q.x(), q.x() * q.y(), q.y() * q.y();
    return values;
  }

  Eigen::RowVector2d centre_;
  double scale_ = 1.0;
  bool is_quadratic_ = true;
  Points2 centres_;
  Eigen::PartialPivLU<Eigen::MatrixXd> solver_;
};

Points2 rows_of(const Points2View& places, const std::vector<std::int32_t>& rows) {
  Points2 chosen(static_cast<Eigen::Index>(rows.size()), 2);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    chosen.row(static_cast<Eigen::Index>(k)) = places.row(rows[k]);
  }
  return chosen;
}

}  // namespace

void Prolongation::build(const coarse_mesh::CoarseMesh& coarse, const Points2View& places,
                         const Points3View& rest_m) {
  faces_ = coarse.faces();
  face_of_.clear();
  for (Eigen::Index v = 0; v < places.rows(); ++v) face_of_.push_back(coarse.location(v).face);
  add_splines(coarse, places);
  add_details(coarse, rest_m);
}

void Prolongation::add_splines(const coarse_mesh::CoarseMesh& coarse, const Points2View& places) {
  const Points2 coarse_places = rows_of(places, coarse.vertices());
  std::vector<std::vector<Share>> shares(face_of_.size());
  std::vector<std::vector<std::int32_t>> in_face(to_index(faces_.rows()));
  for (std::size_t v = 0; v < face_of_.size(); ++v) {
    in_face[to_index(face_of_[v])].push_back(static_cast<std::int32_t>(v));
  }
  const IndexLists faces_of = vertex_faces(faces_, coarse_places.rows());
  for (std::int32_t f = 0; f < faces_.rows(); ++f) {
    if (in_face[to_index(f)].empty()) continue;
    const std::vector<std::int32_t> around = around_face(faces_, faces_of, f);
    worked(static_cast<std::int64_t>(around.size() * around.size() * around.size() / 10));
    const LocalSpline spline(rows_of(coarse_places, around));
    for (const std::int32_t v : in_face[to_index(f)]) {
      const Eigen::VectorXd weights = spline.weights_at(places.row(v));
      for (Eigen::Index k = 0; k < weights.size(); ++k) {
        shares[to_index(v)].push_back({around[to_index(k)], weights[k]});
      }
      for (Eigen::Index k = 0; k < 3 && weights.size() == 0; ++k) {
        shares[to_index(v)].push_back({faces_(f, k), coarse.location(v).weights[k]});
      }
    }
  }
  for (std::int32_t c = 0; c < coarse.count(); ++c) {  // these stay where they are
    shares[to_index(coarse.vertices()[to_index(c)])] = {{c, 1.0}};
  }
  first_.assign(1, 0);
  shares_.clear();
  for (const std::vector<Share>& of_vertex : shares) {
    shares_.insert(shares_.end(), of_vertex.begin(), of_vertex.end());
    first_.push_back(shares_.size());
  }
}

void Prolongation::add_details(const coarse_mesh::CoarseMesh& coarse, const Points3View& rest_m) {
  Points3 coarse_m(coarse.count(), 3);
  for (Eigen::Index c = 0; c < coarse_m.rows(); ++c) {
    coarse_m.row(c) = rest_m.row(coarse.vertices()[to_index(c)]);
  }
  details_m_.resize(0, 3);
  const Points3 missing_m = rest_m - surface_m(coarse_m);
  const double size_m = (rest_m.colwise().maxCoeff() - rest_m.colwise().minCoeff()).norm();
  if (missing_m.cwiseAbs().maxCoeff() <= kNoDetail * size_m) return;
  details_m_.resize(rest_m.rows(), 3);
  for (Eigen::Index v = 0; v < rest_m.rows(); ++v) {
    details_m_.row(v) = missing_m.row(v) * frame(face_of_[to_index(v)], coarse_m);
  }
}

/// Columns: along the first side of the face, in the face across it, and out of its front.
Eigen::Matrix3d Prolongation::frame(std::int32_t face, const Points3View& coarse_m) const {
  const Eigen::Vector3d origin = coarse_m.row(faces_(face, 0)).transpose();
  const Eigen::Vector3d side = coarse_m.row(faces_(face, 1)).transpose() - origin;
  const Eigen::Vector3d other = coarse_m.row(faces_(face, 2)).transpose() - origin;
  Eigen::Matrix3d axes;
  axes.col(0) = side.normalized();
  axes.col(2) = side.cross(other).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

Points3 Prolongation::surface_m(const Points3View& coarse_m) const {
  Points3 fine_m(static_cast<Eigen::Index>(face_of_.size()), 3);
  for (Eigen::Index v = 0; v < fine_m.rows(); ++v) {
    worked_in_loop(v, 5);
    Eigen::RowVector3d place_m = Eigen::RowVector3d::Zero();
    for (std::size_t k = first_[to_index(v)]; k < first_[to_index(v) + 1]; ++k) {
      place_m += shares_[k].weight * coarse_m.row(shares_[k].vertex);
    }
    fine_m.row(v) = place_m;
  }
  if (details_m_.rows() == 0) return fine_m;
  std::vector<Eigen::Matrix3d> frames;
  for (std::int32_t f = 0; f < faces_.rows(); ++f) frames.push_back(frame(f, coarse_m));
  for (Eigen::Index v = 0; v < fine_m.rows(); ++v) {
    worked_in_loop(v);
    const Eigen::Matrix3d& axes = frames[to_index(face_of_[to_index(v)])];
    fine_m.row(v) += details_m_.row(v) * axes.transpose();
  }
  return fine_m;
}

}  // namespace weft::coarse_to_fine
