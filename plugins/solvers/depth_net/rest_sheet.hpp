// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

#include "common/inference/same_template.hpp"

namespace weft::depth_net {

/// An edge of the template's mesh.
struct RestEdge {
  Eigen::Index from = 0, to = 0;
  Eigen::Vector2d vector_m = Eigen::Vector2d::Zero();  ///< from - to, at rest
  double stiffness = 0.0;  ///< [] half of the sum of the cotangents of the opposite angles
};

/// The mesh of a flat template at rest.
class RestSheet {
 public:
  static Result<RestSheet> create(const Template& templ, const inference::FlatSheet& sheet);

  Eigen::Index vertex_count() const { return xy_m_.rows(); }
  Eigen::Vector2d xy_m(Eigen::Index vertex) const { return xy_m_.row(vertex).transpose(); }
  const std::vector<RestEdge>& edges() const { return edges_; }
  /// A third of the area of the faces around a vertex.
  double area_m2(Eigen::Index vertex) const { return area_m2_(vertex); }

  /// The point of the template place xy_m on a shape [V,3]; nothing beyond the mesh.
  std::optional<Eigen::Vector3d> on(const Points3& vertices_m, const Eigen::Vector2d& xy_m) const;

  /// Mean relative error of the edge lengths of a shape [V,3].
  double mean_strain(const Points3& vertices_m) const;

 private:
  RestSheet(Points2 xy_m, Faces faces, FaceLocator locator)
      : xy_m_(std::move(xy_m)), faces_(std::move(faces)), locator_(std::move(locator)) {}
  void set_edges(const MeshTopology& topology);

  Points2 xy_m_;  ///< [V,2] from the least x and y of the template
  Faces faces_;
  FaceLocator locator_;
  std::vector<RestEdge> edges_;
  Eigen::VectorXd area_m2_;
};

}  // namespace weft::depth_net
