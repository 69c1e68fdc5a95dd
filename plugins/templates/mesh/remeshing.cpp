// SPDX-License-Identifier: Apache-2.0
#include "remeshing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/texture_metric.hpp>

#include "chart.hpp"
#include "chart_border.hpp"
#include "common/plane_mesh.hpp"

namespace weft::mesh {
namespace {

using outline::Outline;
using outline::PlaneMesh;
using outline::Polygon;

/// A chart in a plane whose texels are as large as on the surface, in a unit common to all charts.
struct Plane {
  Chart chart;
  Eigen::RowVector2d scale;  ///< [] of the plane to px of the texture, along u and v
  Outline outline;
};

Polygon polygon_of(const Plane& plane, const std::vector<std::int32_t>& border) {
  Polygon polygon;
  for (const std::int32_t v : border) {
    polygon.emplace_back(plane.chart.mesh.flat_px.row(v).cwiseProduct(plane.scale));
  }
  return polygon;
}

/// The border of the largest area goes around the others.
Outline outline_of(const Plane& plane) {
  Outline outline;
  for (const auto& border : plane.chart.borders) {
    outline.holes.push_back(polygon_of(plane, border));
  }
  const auto largest = std::max_element(outline.holes.begin(), outline.holes.end(),
                                        [](const Polygon& a, const Polygon& b) {
                                          return outline::area_px2(a) < outline::area_px2(b);
                                        });
  outline.outer = std::move(*largest);
  outline.holes.erase(largest);
  return outline;
}

std::vector<Plane> planes_of(const TexturedMesh& dense) {
  const double unit_m =
      std::sqrt(texel_pitch(dense.vertices_m, dense.flat_px, dense.faces).m_per_px.prod());
  std::vector<Plane> planes;
  for (Chart& chart : charts_of(dense)) {
    const TexturedMesh& mesh = chart.mesh;
    const auto m_per_px = texel_pitch(mesh.vertices_m, mesh.flat_px, mesh.faces).m_per_px;
    Plane& plane = planes.emplace_back();
    plane.scale = m_per_px.transpose() / unit_m;
    plane.chart = std::move(chart);
    plane.outline = outline_of(plane);
  }
  return planes;
}

/// All planes filled with edges of one length; nothing where borders cross or a chart is lost.
std::optional<std::vector<PlaneMesh>> filled(const std::vector<Plane>& planes, double spacing_px) {
  constexpr int kSmoothingRounds = 10;
  std::vector<PlaneMesh> meshes;
  for (const Plane& plane : planes) {
    Outline outline{evened_border(plane.outline.outer, spacing_px), {}};
    for (const Polygon& hole : plane.outline.holes) {
      outline.holes.push_back(evened_border(hole, spacing_px));
    }
    auto mesh = fill_outline(outline, spacing_px, kSmoothingRounds);
    if (!mesh || mesh->faces.rows() == 0) return std::nullopt;
    meshes.push_back(*std::move(mesh));
  }
  return meshes;
}

/// Those whose vertices are closest to `wanted` in number, by a few tries at the edges' length;
/// nothing where no try succeeds.
std::vector<PlaneMesh> filled_with(const std::vector<Plane>& planes, int wanted) {
  constexpr int kTries = 10;
  constexpr double kClose = 0.01, kFiner = 0.8;
  double area_px2 = 0.0;
  for (const Plane& plane : planes) area_px2 += plane.outline.area_px2();
  double spacing_px = std::sqrt(2.0 * area_px2 / (std::sqrt(3.0) * wanted));
  std::vector<PlaneMesh> best;
  double least = INFINITY;
  for (int round = 0; round < kTries && least > kClose; ++round) {
    auto meshes = filled(planes, spacing_px);
    if (!meshes) {
      spacing_px *= kFiner;
      continue;
    }
    double count = 0.0;
    for (const PlaneMesh& mesh : *meshes) count += static_cast<double>(mesh.flat_px.rows());
    const double off = std::abs(std::log(count / wanted));
    if (off < least) least = off, best = *std::move(meshes);
    spacing_px *= std::sqrt(count / wanted);
  }
  return best;
}

/// Finds points of a plane on its chart: on a face, or else at the nearest point of its border.
class Lifter {
 public:
  static Result<Lifter> create(const Plane& plane) {
    auto locator = FaceLocator::create(plane.chart.mesh.flat_px, plane.chart.mesh.faces, 0.0);
    if (!locator) return locator.error();
    return Lifter(plane, *std::move(locator));
  }

  void add(const Eigen::RowVector2d& at, std::vector<Eigen::RowVector3d>& vertices_m,
           std::vector<Eigen::RowVector2d>& flat_px) const {
    const TexturedMesh& mesh = plane_->chart.mesh;
    const FaceLocation on = locator_.locate(at.cwiseQuotient(plane_->scale));
    if (!on.inside) return add_on_border(at, vertices_m, flat_px);
    Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
    Eigen::RowVector2d in_texture = Eigen::RowVector2d::Zero();
    for (int k = 0; k < 3; ++k) {
      const std::int32_t corner = mesh.faces(on.face, k);
      place += on.weights(k) * mesh.vertices_m.row(corner);
      in_texture += on.weights(k) * mesh.flat_px.row(corner);
    }
    vertices_m.push_back(place), flat_px.push_back(in_texture);
  }

 private:
  Lifter(const Plane& plane, FaceLocator locator) : plane_(&plane), locator_(std::move(locator)) {}

  void add_on_border(const Eigen::RowVector2d& at, std::vector<Eigen::RowVector3d>& vertices_m,
                     std::vector<Eigen::RowVector2d>& flat_px) const {
    const TexturedMesh& mesh = plane_->chart.mesh;
    double least = INFINITY, share = 0.0;
    std::int32_t a = 0, b = 0;
    for (const auto& border : plane_->chart.borders) {
      for (std::size_t i = 0; i < border.size(); ++i) {
        const std::int32_t from = border[i], to = border[(i + 1) % border.size()];
        const Eigen::RowVector2d start = mesh.flat_px.row(from).cwiseProduct(plane_->scale);
        const Eigen::RowVector2d side = mesh.flat_px.row(to).cwiseProduct(plane_->scale) - start;
        const double along = std::clamp(side.dot(at - start) / side.squaredNorm(), 0.0, 1.0);
        const double distance2 = (start + along * side - at).squaredNorm();
        if (distance2 >= least) continue;
        least = distance2, share = along, a = from, b = to;
      }
    }
    const auto between = [&](const auto& rows) {
      return ((1.0 - share) * rows.row(a) + share * rows.row(b)).eval();
    };
    vertices_m.emplace_back(between(mesh.vertices_m));
    flat_px.emplace_back(between(mesh.flat_px));
  }

  const Plane* plane_;
  FaceLocator locator_;
};

Error too_few(const std::string& path) {
  return {Errc::invalid_value,
          path +
              ": so few vertices do not hold its outline in the texture: give more 'vertices', "
              "or 0 for those of the file",
          {}};
}

}  // namespace

Result<TexturedMesh> remeshed(const std::string& path, const TexturedMesh& dense, int vertices) {
  const std::vector<Plane> planes = planes_of(dense);
  const std::vector<PlaneMesh> meshes = filled_with(planes, vertices);
  if (meshes.empty()) return too_few(path);
  std::vector<Eigen::RowVector3d> vertices_m;
  std::vector<Eigen::RowVector2d> flat_px;
  std::vector<Faces> faces;
  Eigen::Index face_count = 0;
  for (std::size_t c = 0; c < planes.size(); ++c) {
    const auto lifter = Lifter::create(planes[c]);
    if (!lifter) return lifter.error();
    const auto first = static_cast<std::int32_t>(vertices_m.size());
    for (Eigen::Index v = 0; v < meshes[c].flat_px.rows(); ++v) {
      lifter->add(meshes[c].flat_px.row(v), vertices_m, flat_px);
    }
    faces.emplace_back(meshes[c].faces.array() + first);
    face_count += faces.back().rows();
  }
  const auto count = static_cast<Eigen::Index>(vertices_m.size());
  TexturedMesh mesh{Points3(count, 3), Points2(count, 2), Faces(face_count, 3)};
  for (Eigen::Index v = 0; v < count; ++v) {
    mesh.vertices_m.row(v) = vertices_m[to_index(v)];
    mesh.flat_px.row(v) = flat_px[to_index(v)];
  }
  Eigen::Index next = 0;
  for (const Faces& own : faces) {
    mesh.faces.middleRows(next, own.rows()) = own;
    next += own.rows();
  }
  if (!validate_mesh(mesh.vertices_m, mesh.faces) ||
      !validate_flat_mesh(mesh.flat_px, mesh.faces)) {
    return too_few(path);
  }
  return mesh;
}

}  // namespace weft::mesh
