// SPDX-License-Identifier: Apache-2.0
#include "remeshing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/solid/validation.hpp>
#include <weft/geometry/texture_metric.hpp>

#include "chart.hpp"
#include "chart_border.hpp"
#include "coincidence.hpp"
#include "common/plane_mesh.hpp"
#include "seams.hpp"

namespace weft::mesh {
namespace {

using outline::Outline;
using outline::Polygon;

constexpr int kSmoothingRounds = 10;

/// Size of the planes' unit on the surface.
double unit_of(const TexturedMesh& dense) {
  return std::sqrt(texel_pitch(dense.vertices_m, dense.flat_px, dense.faces).m_per_px.prod());
}

std::vector<Plane> planes_of(const TexturedMesh& dense) {
  std::vector<Plane> planes;
  for (Chart& chart : charts_of(dense)) {
    const TexturedMesh& mesh = chart.mesh;
    const auto m_per_px = texel_pitch(mesh.vertices_m, mesh.flat_px, mesh.faces).m_per_px;
    Plane& plane = planes.emplace_back();
    plane.scale = m_per_px.transpose() / unit_of(dense);
    plane.chart = std::move(chart);
    std::vector<Polygon> borders;
    for (const auto& border : plane.chart.borders) borders.push_back(polygon_along(plane, border));
    plane.outline = outline_of(std::move(borders));
  }
  return planes;
}

/// All planes filled with edges of one length, without seams; empty where borders cross or a chart
/// is lost.
std::vector<ChartMesh> filled(const std::vector<Plane>& planes, double spacing_px) {
  std::vector<ChartMesh> meshes;
  for (const Plane& plane : planes) {
    Outline outline{evened_border(plane.outline.outer, spacing_px), {}};
    for (const Polygon& hole : plane.outline.holes) {
      outline.holes.push_back(evened_border(hole, spacing_px));
    }
    auto mesh = fill_outline(outline, spacing_px, kSmoothingRounds);
    if (!mesh || mesh->faces.rows() == 0) return {};
    meshes.push_back({*std::move(mesh)});
  }
  return meshes;
}

/// Those whose vertices are closest to `wanted` in number, by a few tries at the edges' length;
/// empty where no try succeeds.
std::vector<ChartMesh> filled_with(const std::vector<Plane>& planes, double unit_m, int wanted) {
  constexpr int kTries = 10;
  constexpr double kClose = 0.01, kFiner = 0.8;
  Seams seams(planes);
  double area_px2 = 0.0;
  for (const Plane& plane : planes) area_px2 += plane.outline.area_px2();
  double spacing_px = std::sqrt(2.0 * area_px2 / (std::sqrt(3.0) * wanted));
  std::vector<ChartMesh> best;
  double least = INFINITY;
  for (int round = 0; round < kTries && least > kClose; ++round) {
    auto meshes = seams.empty() ? filled(planes, spacing_px)
                                : seams.fill(spacing_px, unit_m, kSmoothingRounds);
    if (meshes.empty()) {
      spacing_px *= kFiner;
      continue;
    }
    double count = 0.0;
    for (const ChartMesh& mesh : meshes) count += static_cast<double>(mesh.plane.flat_px.rows());
    const double off = std::abs(std::log(count / wanted));
    if (off < least) least = off, best = std::move(meshes);
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
  const std::vector<ChartMesh> meshes = filled_with(planes, unit_of(dense), vertices);
  if (meshes.empty()) return too_few(path);
  std::vector<Eigen::RowVector3d> vertices_m;
  std::vector<Eigen::RowVector2d> flat_px;
  std::vector<Faces> faces;
  Eigen::Index face_count = 0;
  for (std::size_t c = 0; c < planes.size(); ++c) {
    const auto lifter = Lifter::create(planes[c]);
    if (!lifter) return lifter.error();
    const auto first = static_cast<std::int32_t>(vertices_m.size());
    const auto& [plane, shared] = meshes[c];
    for (std::int32_t v = 0; v < plane.flat_px.rows(); ++v) {
      const auto fixed = shared.find(v);
      if (fixed == shared.end()) {
        lifter->add(plane.flat_px.row(v), vertices_m, flat_px);
      } else {
        vertices_m.push_back(fixed->second.place_m), flat_px.push_back(fixed->second.flat_px);
      }
    }
    faces.emplace_back(plane.faces.array() + first);
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
      !validate_flat_mesh(mesh.flat_px, mesh.faces) ||
      !build_topology(welded_faces(mesh.faces, welded_vertices(mesh.vertices_m)), count)) {
    return too_few(path);
  }
  return mesh;
}

}  // namespace weft::mesh
