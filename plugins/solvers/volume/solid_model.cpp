// SPDX-License-Identifier: Apache-2.0
#include "solid_model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>

#include "common/cholesky/couplings.hpp"
#include "thick_parts.hpp"

namespace weft::volume {
namespace {

Error mistake(const std::string& what) { return {Errc::invalid_data, "the template: " + what}; }

using Box = Eigen::Matrix<double, 3, 2>;

Box box_of(const Points3View& points_m) {
  Box box;
  box.col(0) = points_m.colwise().minCoeff().transpose();
  box.col(1) = points_m.colwise().maxCoeff().transpose();
  return box;
}

bool overlap(const Box& a, const Box& b, double slack_m) {
  return ((a.col(0).array() <= b.col(1).array() + slack_m) &&
          (b.col(0).array() <= a.col(1).array() + slack_m))
      .all();
}

}  // namespace

Result<void> SolidModel::build(const Template& templ) {
  if (!templ.is_solid()) {
    return mistake(
        "has no tetrahedra: build it with templates/volume, or use a solver of surfaces");
  }
  if (auto read = read_body(templ); !read) return read;
  if (auto read = read_surface(templ); !read) return read;
  parts_ = thick_parts(*this);
  number_couplings();
  add_unevenness();
  return {};
}

Result<void> SolidModel::read_body(const Template& templ) {
  nodes_m_ = templ.nodes_m.matrix<3>();
  if (!nodes_m_.allFinite()) return mistake("a node is not finite");
  tetrahedra_.clear();
  volume_m3_ = 0.0;
  const auto* filled = templ.others.find<double>("x.weft.filled_share");
  const std::int64_t count = templ.tetrahedra.rows();
  for (std::int64_t e = 0; e < count; ++e) {
    worked_in_loop(e, 3);
    const bool has_share = filled != nullptr && filled->rows() == count;
    auto added = add_tetrahedron(templ.tetrahedra.row(e), e, has_share ? (*filled)(e) : 1.0);
    if (!added) return added;
  }
  if (tetrahedra_.empty()) return mistake("has no tetrahedra");
  for (Tetrahedron& each : tetrahedra_) each.share /= volume_m3_;
  return {};
}

void SolidModel::number_couplings() {
  solvers::Couplings numbers;
  for (Tetrahedron& each : tetrahedra_) {
    std::size_t pair = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a + 1; b < 4; ++b) {
        each.coupling[pair++] = numbers.of(each.node[a], each.node[b]);
      }
    }
  }
  for (ThickPart& each : parts_) {
    each.coupling.clear();
    for (std::size_t a = 0; a < each.node.size(); ++a) {
      for (std::size_t b = a + 1; b < each.node.size(); ++b) {
        each.coupling.push_back(numbers.of(each.node[a], each.node[b]));
      }
    }
  }
  couplings_ = numbers.pairs();
}

void SolidModel::add_unevenness() {
  uneven_diagonal_.assign(to_index(nodes_m_.rows()), 0.0);
  uneven_coupling_.assign(couplings_.size(), 0.0);
  for (const ThickPart& part : parts_) {
    std::size_t at = 0, pair = 0;
    for (std::size_t a = 0; a < part.node.size(); ++a) {
      uneven_diagonal_[to_index(part.node[a])] += part.share * part.unevenness[at++];
      for (std::size_t b = a + 1; b < part.node.size(); ++b) {
        uneven_coupling_[to_index(part.coupling[pair++])] += part.share * part.unevenness[at++];
      }
    }
  }
}

Result<void> SolidModel::add_tetrahedron(const std::int32_t* node, std::int64_t index,
                                         double filled) {
  Tetrahedron made;
  for (std::size_t a = 0; a < 4; ++a) {
    if (node[a] < 0 || node[a] >= nodes_m_.rows()) {
      return mistake("tetrahedron " + std::to_string(index) + " names node " +
                     std::to_string(node[a]) + " of " + std::to_string(nodes_m_.rows()));
    }
    made.node[a] = node[a];
  }
  Eigen::Matrix3d sides;
  for (int k = 0; k < 3; ++k) {
    sides.col(k) = (nodes_m_.row(node[k + 1]) - nodes_m_.row(node[0])).transpose();
  }
  const double volume_m3 = sides.determinant() / 6.0;
  if (!(volume_m3 > 0.0) || !(filled > 0.0)) {
    return mistake("tetrahedron " + std::to_string(index) + " has no volume");
  }
  const Eigen::Matrix3d inverse = sides.inverse();
  made.slopes.rightCols<3>() = inverse.transpose();
  made.slopes.col(0) = -inverse.colwise().sum().transpose();
  made.share = volume_m3 * filled;
  volume_m3_ += made.share;
  tetrahedra_.push_back(made);
  return {};
}

Result<void> SolidModel::read_surface(const Template& templ) {
  vertices_m_ = templ.vertices_m.matrix<3>();
  faces_ = templ.faces.matrix<3>();
  diagonal_m_ = (vertices_m_.colwise().maxCoeff() - vertices_m_.colwise().minCoeff()).norm();
  vertices_.clear();
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) {
    const std::int32_t e = templ.vertex_tetrahedron(v);
    const Eigen::Vector4d weights = templ.vertex_barycentric.matrix<4>().row(v).transpose();
    if (e < 0 || to_index(e) >= tetrahedra_.size() || !weights.allFinite()) {
      return mistake("vertex " + std::to_string(v) + " lies in no tetrahedron");
    }
    vertices_.push_back({e, weights});
  }
  std::vector<Box> boxes;
  for (const Tetrahedron& each : tetrahedra_) {
    Points3 corners(4, 3);
    for (int a = 0; a < 4; ++a) corners.row(a) = nodes_m_.row(each.node[to_index(a)]);
    boxes.push_back(box_of(corners));
  }
  candidates_.assign(to_index(faces_.rows()), {});
  const double slack_m = 1e-9 * diagonal_m_;
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    worked(static_cast<std::int64_t>(boxes.size()) / 8);
    Points3 corners(3, 3);
    for (int k = 0; k < 3; ++k) corners.row(k) = vertices_m_.row(faces_(f, k));
    const Box box = box_of(corners);
    for (std::size_t e = 0; e < boxes.size(); ++e) {
      if (overlap(box, boxes[e], slack_m)) {
        candidates_[to_index(f)].push_back(static_cast<std::int32_t>(e));
      }
    }
  }
  return {};
}

Eigen::Vector4d SolidModel::weights_in(std::int32_t tetrahedron,
                                       const Eigen::Vector3d& point_m) const {
  const Tetrahedron& in = tetrahedra_[to_index(tetrahedron)];
  const Eigen::Vector3d off = point_m - nodes_m_.row(in.node[0]).transpose();
  Eigen::Vector4d weights = in.slopes.transpose() * off;
  weights[0] += 1.0;
  return weights;
}

BodyPoint SolidModel::point_of(std::int32_t face, const Eigen::Vector3d& weights) const {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) point_m += weights[k] * vertices_m_.row(faces_(face, k)).transpose();
  const BodyPoint& corner = vertices_[to_index(faces_(face, 0))];
  BodyPoint best{corner.tetrahedron, weights_in(corner.tetrahedron, point_m)};
  for (const std::int32_t e : candidates_[to_index(face)]) {
    const Eigen::Vector4d inside = weights_in(e, point_m);
    if (inside.minCoeff() > best.weights.minCoeff()) best = {e, inside};
  }
  return best;
}

Points3 SolidModel::surface_of(const Points3& nodes_m) const {
  Points3 surface_m(static_cast<Eigen::Index>(vertices_.size()), 3);
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    surface_m.row(static_cast<Eigen::Index>(v)) = vertices_[v].on(tetrahedra_, nodes_m).transpose();
  }
  return surface_m;
}

}  // namespace weft::volume
