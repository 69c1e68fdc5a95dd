// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/checks.hpp"

#include <weft/data/ground_truth.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_check.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/solid/validation.hpp>
#include <weft/geometry/surface_size.hpp>

namespace weft {

using host::arrays_of;
using host::Record;
using host::view_as;

namespace {

Error broken(std::string message) { return {Errc::invalid_data, std::move(message), {}}; }

/// Indices from `least` to `count` - 1.
Result<void> check_indices(const Array<std::int32_t>& indices, std::int64_t least,
                           std::int64_t count, const char* what) {
  for (std::int64_t i = 0; i < indices.rows(); ++i) {
    const std::int32_t index = indices(i);
    if (index >= least && index < count) continue;
    return broken(std::string(what) + " " + std::to_string(i) + " has the index " +
                  std::to_string(index) + ", the template has " + std::to_string(count));
  }
  return {};
}

template <class T>
Result<void> check_size(const char* what, const Array<T>& pixels, const Camera& camera) {
  if (pixels.dim(0) == camera.height_px && pixels.dim(1) == camera.width_px) return {};
  const auto size = [](std::int64_t width, std::int64_t height) {
    return std::to_string(width) + "x" + std::to_string(height) + " px";
  };
  return broken(std::string(what) + " has " + size(pixels.dim(1), pixels.dim(0)) + ", the camera " +
                size(camera.width_px, camera.height_px));
}

/// One overload for each record that depends on template or camera.
class FitCheck {
 public:
  FitCheck(const Template& templ, const Camera& camera) : templ_(templ), camera_(camera) {}

  Result<void> operator()(const Shape& shape) const {
    const ShapeState state = shape.shape_state();
    if (state != ShapeState::estimated && state != ShapeState::weak) {
      return broken("a solver may set only estimated or weak");
    }
    for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v) {
      const double z_m = shape.vertices_m(v, 2);
      if (z_m > 0.0) continue;
      return no_result("the shape reaches behind the camera: its vertex " + std::to_string(v) +
                       " has Z = " + std::to_string(z_m) + " m");
    }
    return {};
  }
  Result<void> operator()(const Sightlines& sightlines) const {
    auto status =
        check_indices(sightlines.vertex, -1, templ_.vertices_m.rows(), "the vertex of sightline");
    if (!status) return status;
    return check_indices(sightlines.face, -1, templ_.faces.rows(), "the face of sightline");
  }
  Result<void> operator()(const Correspondences& matches) const {
    return check_indices(matches.face, -1, templ_.faces.rows(), "the face of match");
  }
  Result<void> operator()(const KnownPoints& points) const {
    const std::int64_t least = points.template_xy_m.present() ? -1 : 0;
    return check_indices(points.vertex, least, templ_.vertices_m.rows(),
                         "the vertex of known point");
  }
  Result<void> operator()(const Image& image) const {
    return check_size("the image", image.pixels, camera_);
  }
  Result<void> operator()(const Region& region) const {
    return check_size("the region", region.mask, camera_);
  }
  Result<void> operator()(const GroundTruth& truth) const {
    if (truth.faces.present()) {
      const auto legal = check_face_indices(truth.faces.matrix<3>(), truth.count());
      if (!legal) return broken("the true surface: " + legal.error().message);
    }
    if (auto legal = check_cloud(truth); !legal) return legal;
    Result<void> fits;
    if (truth.depth_m.present()) fits = check_size("the true depth", truth.depth_m, camera_);
    if (fits && truth.uv_m.present()) fits = check_size("the true uv", truth.uv_m, camera_);
    return fits;
  }

 private:
  static Result<void> check_cloud(const GroundTruth& truth) {
    if (truth.cloud_faces.present()) {
      const std::int64_t points = truth.cloud_m.present() ? truth.cloud_m.rows() : 0;
      const auto legal = check_face_indices(truth.cloud_faces.matrix<3>(), points);
      if (!legal) return broken("the true cloud: " + legal.error().message);
    }
    const auto parts = static_cast<std::int64_t>(truth.parts().size());
    for (const auto* part_of : {&truth.point_part, &truth.cloud_part}) {
      for (std::int64_t i = 0; part_of->present() && i < part_of->rows(); ++i) {
        const std::int32_t part = (*part_of)(i);
        if (part >= -1 && part < parts) continue;
        return broken("the true point " + std::to_string(i) + " belongs to part " +
                      std::to_string(part) + ", the truth names " + std::to_string(parts));
      }
    }
    return {};
  }

  const Template& templ_;
  const Camera& camera_;
};

}  // namespace

Result<void> check_template(const Record& templ) {
  const auto sheet = view_as<Template>(templ);
  if (!sheet) return sheet.error();
  if (const std::int64_t count = sheet->vertices_m.rows(); count > kMostTemplateVertices) {
    return broken("the template has " + std::to_string(count) +
                  " vertices, the stages bear at most " + std::to_string(kMostTemplateVertices) +
                  ": lower its columns and rows, widen its spacing or give a coarser mesh file");
  }
  for (int axis = 0; axis < 2; ++axis) {
    if (sheet->texture.dim(axis) != sheet->mask.dim(axis) || sheet->texture.dim(axis) < 1) {
      return broken("the template's texture and mask must have the same, non-zero size");
    }
  }
  if (sheet->m_per_px.present() && !(sheet->m_per_px(0) > 0 && sheet->m_per_px(1) > 0)) {
    return broken("the template's m_per_px must be above 0");
  }
  const auto faces = sheet->faces.matrix<3>();
  if (auto valid = validate_mesh(sheet->vertices_m.matrix<3>(), faces); !valid) return valid;
  if (auto valid = validate_flat_mesh(sheet->flat_px.matrix<2>(), faces); !valid) return valid;
  return validate_solid(*sheet);
}

std::string size_doubt_of(const Record& templ, const std::string& length) {
  const auto arrays = view_as<Template>(templ);
  if (!arrays) return {};
  const Points3 vertices_m = arrays->vertices_m.matrix<3>();
  const double largest_m =
      (vertices_m.colwise().maxCoeff() - vertices_m.colwise().minCoeff()).maxCoeff();
  return size_doubt(largest_m, length);
}

Result<void> check_camera(const Record& camera) {
  const auto pinhole = view_as<Camera>(camera);
  if (!pinhole) return pinhole.error();
  if (const auto mistake = camera_mistake(*pinhole)) {
    return broken("the camera cannot be right: " + mistake->message);
  }
  return {};
}

Result<void> check_fits(const Record& record, const Record& templ, const Record& camera) {
  const auto sheet = arrays_of<Template>(templ);
  const auto pinhole = arrays_of<Camera>(camera);
  if (!sheet) return sheet.error();
  if (!pinhole) return pinhole.error();
  const FitCheck check(*sheet, *pinhole);
  Result<void> status;
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    if constexpr (requires(const RecordType& typed) { check(typed); }) {
      if (record.type() != RecordType::kType) return;
      const auto typed = arrays_of<RecordType>(record);
      status = typed ? check(*typed) : Result<void>(typed.error());
    }
  });
  return status;
}

}  // namespace weft
