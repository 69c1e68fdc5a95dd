// SPDX-License-Identifier: Apache-2.0
#include "flattening.hpp"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/ARAP_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/texture_metric.hpp>

namespace weft::mesh {
namespace {

namespace parameterization = CGAL::Surface_mesh_parameterization;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

Error no_disc(const MeshFile& file, const std::string& what) {
  return {Errc::invalid_data,
          file.path + ": " + what +
              ", so it cannot be laid flat in one piece: cut it in a modelling program and give it "
              "texture coordinates",
          {}};
}

Result<Mesh> to_mesh(const MeshFile& file, const Surface& surface) {
  Mesh mesh;
  for (Eigen::Index v = 0; v < surface.vertices.rows(); ++v) {
    mesh.add_vertex({surface.vertices(v, 0), surface.vertices(v, 1), surface.vertices(v, 2)});
  }
  const auto vertex = [&](Eigen::Index f, int k) {
    return Mesh::Vertex_index(static_cast<Mesh::size_type>(surface.faces(f, k)));
  };
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f) {
    if (mesh.add_face(vertex(f, 0), vertex(f, 1), vertex(f, 2)) != Mesh::null_face()) continue;
    return file.mistake(file.faces[to_index(f)],
                        "does not go on what is beside it: it turns the other way, or touches it "
                        "at a corner only; make the mesh one surface with one orientation");
  }
  return mesh;
}

Result<Mesh::Halfedge_index> only_border(const MeshFile& file, const Surface& surface,
                                         const Mesh& mesh) {
  const auto euler = static_cast<std::int64_t>(mesh.number_of_vertices() + mesh.number_of_faces()) -
                     static_cast<std::int64_t>(mesh.number_of_edges());
  if (surface.parts > 1) return no_disc(file, "the surface has several parts");
  for (const Mesh::Halfedge_index halfedge : mesh.halfedges()) {
    if (!mesh.is_border(halfedge)) continue;
    if (euler != 1) return no_disc(file, "the surface has holes or handles");
    return halfedge;
  }
  return no_disc(file, "the surface is closed");
}

/// The map turned so that the smallest rectangle around it is upright.
Points2 upright(const Surface& surface, const Points2& flat) {
  const auto topology = build_topology(surface.faces, flat.rows());
  double least = std::numeric_limits<double>::infinity();
  Eigen::Rotation2Dd turn(0.0);
  for (const std::int32_t e : topology->boundary_edges) {
    const Eigen::Vector2d side = flat.row(topology->edges(e, 1)) - flat.row(topology->edges(e, 0));
    const Eigen::Rotation2Dd candidate(-std::atan2(side.y(), side.x()));
    const Points2 turned = flat * candidate.toRotationMatrix().transpose();
    const double area = (turned.colwise().maxCoeff() - turned.colwise().minCoeff()).prod();
    if (area >= (1.0 - 1e-9) * least) continue;
    least = area;
    turn = candidate;
  }
  return flat * turn.toRotationMatrix().transpose();
}

/// Where the file's up direction points to in the plane.
Eigen::Vector2d direction_of_up(const Surface& surface, const Points2& flat) {
  constexpr double kLying = 0.1;  // share of the area
  Eigen::Matrix<double, 3, 2> sum = Eigen::Matrix<double, 3, 2>::Zero();
  double area = 0.0;
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f) {
    const double own = face_area(surface.vertices, surface.faces, f);
    sum += own * texture_jacobian(surface.vertices, flat, surface.faces, f);
    area += own;
  }
  const Eigen::Vector2d up = sum.row(1);
  return up.norm() > kLying * area ? up : Eigen::Vector2d(-sum.row(2));
}

}  // namespace

Result<Points2> flattened(const MeshFile& file, const Surface& surface) {
  auto mesh = to_mesh(file, surface);
  if (!mesh) return mesh.error();
  const auto border = only_border(file, surface, *mesh);
  if (!border) return border.error();
  auto uv = mesh->add_property_map<Mesh::Vertex_index, Kernel::Point_2>("v:uv").first;
  parameterization::ARAP_parameterizer_3<Mesh> rigid;
  if (parameterization::parameterize(*mesh, rigid, *border, uv) != parameterization::OK) {
    return no_disc(file, "the surface folds over itself when it is laid flat");
  }
  Points2 flat(surface.vertices.rows(), 2);
  for (const Mesh::Vertex_index v : mesh->vertices()) {
    flat.row(static_cast<Eigen::Index>(v)) << uv[v].x(), uv[v].y();
  }
  flat = upright(surface, flat);
  const Eigen::Vector2d up = direction_of_up(surface, flat);
  const double quarter = std::round((0.5 * M_PI - std::atan2(up.y(), up.x())) / (0.5 * M_PI));
  const Eigen::Rotation2Dd turn(0.5 * M_PI * quarter);
  flat = (flat * turn.toRotationMatrix().transpose()).eval();
  flat.rowwise() -= flat.colwise().minCoeff().eval();
  const Eigen::RowVector2d extent = flat.colwise().maxCoeff();
  flat.array().rowwise() /= extent.array();
  return flat;
}

}  // namespace weft::mesh
