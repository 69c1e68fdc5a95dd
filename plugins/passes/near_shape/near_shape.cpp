// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/sdk/pass.hpp>

namespace weft::near_shape {
namespace {

/// A box of pixels, ends included.
struct Box {
  double left_px, top_px, right_px, bottom_px;
};

Box box_around(const Points2& corners_px) {
  const Eigen::RowVector2d least = corners_px.colwise().minCoeff();
  const Eigen::RowVector2d most = corners_px.colwise().maxCoeff();
  return {least[0], least[1], most[0], most[1]};
}

/// Marks the pixels whose centre lies in the box.
void mark(const Box& box, Array<std::uint8_t>& mask) {
  const auto inside = [](double at_px, std::int64_t size) {
    return static_cast<std::int64_t>(std::clamp(at_px, 0.0, static_cast<double>(size)));
  };
  const std::int64_t left = inside(std::ceil(box.left_px), mask.dim(1));
  const std::int64_t right = inside(std::floor(box.right_px) + 1.0, mask.dim(1));
  const std::int64_t top = inside(std::ceil(box.top_px), mask.dim(0));
  const std::int64_t bottom = inside(std::floor(box.bottom_px) + 1.0, mask.dim(0));
  for (std::int64_t y = top; left < right && y < bottom; ++y) {
    std::fill_n(mask.row(y) + left, right - left, std::uint8_t{1});
  }
}

/// The part of the image in which the surface can be, by its shape of the frame before.
class NearShape final : public Pass {
 public:
  static constexpr About kAbout{.reads = "previous.shape correspondences", .produces = "region"};

  explicit NearShape(Params& p) {
    p.read("margin", margin_, "", {0.0, 10.0},
           "maximum expected movement of the surface, relative to the longer side of its box in "
           "the image");
    p.read("least_confidence", least_confidence_, "", {0.0, 1.0},
           "minimum confidence of a previous shape that is used");
    p.read("longest_age", longest_age_, "frames", {1, 1000000},
           "age from which a previous shape is ignored");
    p.read("parts", parts_, "", {1, 1000},
           "number of strips of the template; each frame searches the next one; 1: the whole "
           "surface");
  }

  Result<PassOutput> run(const PassInput& in) override {
    const auto& shape = in.previous_shape;
    if (shape && shape->vertices_m.rows() != in.templ.vertices_m.rows()) {
      return Error{Errc::invalid_data,
                   "the previous shape has " + std::to_string(shape->vertices_m.rows()) +
                       " vertices, the template " + std::to_string(in.templ.vertices_m.rows()) +
                       ": use one template throughout"};
    }
    const FacesView faces = in.templ.faces.matrix<3>();
    if (auto checked = check_face_indices(faces, in.templ.vertices_m.rows()); !checked) {
      return checked.error();
    }
    if (const std::string why = why_not_trusted(shape); !why.empty()) return whole(in, why);
    if (parts_ > 1 && !has_matches(in)) return whole(in, "no match shows the surface");
    const Pinhole camera{in.camera.fx, in.camera.fy, in.camera.cx, in.camera.cy};
    const Points2 pixels = project_points(camera, shape->vertices_m.matrix<3>());
    if (!pixels.allFinite()) return whole(in, "the previous shape reaches behind the camera");
    PassOutput out;
    out.region = around(pixels, faces_of_part(in, faces), in.camera);
    const Array<std::uint8_t>& mask = out.region->mask;
    if (std::find(mask.data(), mask.data() + mask.size(), 1) == mask.data() + mask.size()) {
      return whole(in, "the previous shape, or the strip, lies outside of the image");
    }
    return out;
  }

 private:
  /// Empty where it is.
  std::string why_not_trusted(const std::optional<Shape>& shape) const {
    if (!shape) return "there is no previous shape";
    if (shape->shape_state() == ShapeState::lost) return "the previous shape is lost";
    if (shape->age_frames >= longest_age_) {
      return "the previous shape was measured " + std::to_string(shape->age_frames) +
             " frames before the previous one";
    }
    return shape->confidence >= least_confidence_ ? "" : "the previous shape is not sure enough";
  }

  static Result<PassOutput> whole(const PassInput& in, const std::string& why) {
    PassOutput out;
    out.region = filled(in.camera, 1);
    return degenerate(std::move(out), why + ": the whole image is searched");
  }

  static Region filled(const Camera& camera, std::uint8_t value) {
    Array<std::uint8_t> mask({camera.height_px, camera.width_px});
    std::fill_n(mask.data(), mask.size(), value);
    return {std::move(mask)};
  }

  static bool has_matches(const PassInput& in) {
    if (!in.correspondences) return false;
    const Array<std::uint8_t>& kept = in.correspondences->kept;
    return std::find(kept.data(), kept.data() + kept.size(), 1) != kept.data() + kept.size();
  }

  /// The faces [f,3] of the strip that is searched in this frame: across the longer side of the
  /// template, by the centres of the faces.
  Faces faces_of_part(const PassInput& in, const FacesView& faces) const {
    const auto flat_px = in.templ.flat_px.matrix<2>();
    const Eigen::RowVector2d least = flat_px.colwise().minCoeff();
    const Eigen::RowVector2d size = flat_px.colwise().maxCoeff() - least;
    const int axis = size[0] >= size[1] ? 0 : 1;
    const auto part = static_cast<double>(in.call.frame() % static_cast<std::uint64_t>(parts_));
    Faces of_part(faces.rows(), 3);
    Eigen::Index count = 0;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      double centre = -least[axis];
      for (Eigen::Index k = 0; k < 3; ++k) centre += flat_px(faces(f, k), axis) / 3.0;
      const double strip = std::floor(centre / size[axis] * static_cast<double>(parts_));
      if (strip == part) of_part.row(count++) = faces.row(f);
    }
    of_part.conservativeResize(count, 3);
    return of_part;
  }

  Region around(const Points2& pixels, const Faces& faces, const Camera& camera) const {
    const Box all = box_around(pixels);
    const double grown_px =
        margin_ * std::max(all.right_px - all.left_px, all.bottom_px - all.top_px);
    Region region = filled(camera, 0);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      Points2 corners_px(3, 2);
      for (Eigen::Index k = 0; k < 3; ++k) corners_px.row(k) = pixels.row(faces(f, k));
      const Box box = box_around(corners_px);
      mark({box.left_px - grown_px, box.top_px - grown_px, box.right_px + grown_px,
            box.bottom_px + grown_px},
           region.mask);
    }
    return region;
  }

  double margin_ = 0.15;
  double least_confidence_ = 0.5;
  std::int64_t longest_age_ = 1;
  std::int64_t parts_ = 1;
};

}  // namespace
}  // namespace weft::near_shape

using weft::near_shape::NearShape;
WEFT_PLUGIN(NearShape, "passes/near_shape", "1.0.0",
            "Gives detectors the image region around the previous shape.")
