// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/surface_size.hpp>
#include <weft/sdk/template_builder.hpp>

#include "common/images/texture_file.hpp"
#include "common/plane_mesh.hpp"
#include "polygons.hpp"
#include "segmentation.hpp"

namespace weft::outline {
namespace {

/// The dimension with a known length.
enum class Measured { width, height, longest, picture };

/// A flat object of any outline, from one photograph of it: found on its plain background,
/// outlined, and filled with a constrained Delaunay mesh. Vertices are at s (u, v, 0), s metres in
/// a pixel.
class OutlineTemplate final : public TemplateBuilder {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Shetab-Bushehri et al., ROBUSfT, arXiv:2301.04037 (2023); Shewchuk, Delaunay "
          "refinement algorithms for triangular mesh generation (2002)",
      .licence = "GPL-3.0-or-later"};

  explicit OutlineTemplate(Params& p) {
    p.input_path("photo", photo_path_, "photograph of the object, flat, on a plain background",
                 Need::required);
    p.input_path("mask", mask_path_, "mask image that is light where the object is");
    p.read("threshold", threshold_, "L*a*b*", {0.0, 200.0},
           "colour distance from the background above which a pixel belongs to the object; 0: "
           "found by Otsu's method");
    p.read("smallest_hole", smallest_hole_, "share of the area in the outline", {0.0, 1.0},
           "area below which a hole is filled; 1: all holes are filled");
    p.read("length_m", length_m_, "m", {1e-6, 1000.0}, "known length of the object",
           Need::required);
    p.choice(
        "length_of", measured_,
        {{"width", Measured::width},
         {"height", Measured::height},
         {"longest", Measured::longest},
         {"picture", Measured::picture}},
        "dimension that length_m gives; width, height: of the object in the photograph; longest: "
        "largest distance between two of its points; picture: width of the whole photograph");
    p.read("spacing_mm", spacing_mm_, "mm", {0.0, 1e6},
           "length of the mesh edges; 0: derived from 'vertices'");
    p.read("vertices", vertices_, "", {3, 100000},
           "approximate number of mesh vertices if spacing_mm is 0");
    p.read("smoothing_rounds", smoothing_rounds_, "", {0, 1000},
           "number of rounds that smooth the mesh; 0: refined mesh without smoothing");
  }

  void check(Mistakes& mistakes) const {
    mistakes.expect("photo", image_files::check_texture_file("photo", photo_path_));
    if (!mask_path_.empty()) {
      mistakes.expect("mask", image_files::check_texture_file("mask", mask_path_));
    }
    mistakes.doubt("length_m", size_doubt(length_m_, "length_m"));
  }

  Result<Template> build(const Call& call) override {
    auto texture = image_files::read_texture_file("photo", photo_path_);
    if (!texture) return texture.error();
    image_files::report_orientation(call, photo_path_, texture->orientation);
    auto object = find_object(*texture);
    if (!object) return in_photo(object.error());
    texture->mask = *object;
    const Outline outline = trace_outline(texture->mask);
    const double m_per_px = length_m_ / length_px(outline.outer, texture->mask.cols);
    const double spacing_px = spacing(outline, m_per_px);
    if (auto legal = check_spacing(outline, spacing_px, m_per_px); !legal) return legal.error();
    auto mesh = fill_outline(resampled(outline, spacing_px), spacing_px, smoothing_rounds_);
    if (!mesh) return in_photo(mesh.error());
    if (auto whole = check_whole(outline, *mesh, spacing_px); !whole)
      return in_photo(whole.error());
    Template templ = assemble(*mesh, m_per_px);
    image_files::store(*texture, templ);
    if (!touches_border(texture->mask)) return templ;
    return degenerate(std::move(templ), photo_path_ +
                                            ": the object reaches the border of the photograph, "
                                            "where it may be cut off: leave a margin around it");
  }

 private:
  static constexpr double kMostVertices = 2e5;
  // Whole objects need 1 to 2 times the vertices of a lattice, and a triangle has three.
  static constexpr double kMostRefined = 3.0, kLeastMesh = 12.0;

  Error in_photo(Error error) const {
    error.message.insert(0, photo_path_ + ": ");
    return error;
  }

  Result<cv::Mat> find_object(const image_files::Texture& photo) const {
    if (!mask_path_.empty()) {
      auto mask = image_files::read_texture_file("mask", mask_path_);
      if (!mask) return mask.error();
      if (mask->pixels.size() != photo.pixels.size()) {
        return Error{Errc::invalid_data, mask_path_ +
                                             ": the mask must have the size of the photograph, " +
                                             std::to_string(photo.pixels.cols) + " x " +
                                             std::to_string(photo.pixels.rows) + " px"};
      }
      const bool sideways = turns(mask->orientation).sideways;
      const bool size_tells =
          sideways != turns(photo.orientation).sideways && photo.pixels.cols != photo.pixels.rows;
      if (mask->orientation != photo.orientation && !size_tells) {
        return Error{Errc::invalid_data, mask_path_ + ": " + orientation_text(mask->orientation) +
                                             " to be upright, but the photograph " +
                                             orientation_text(photo.orientation) +
                                             ": save both with the same orientation"};
      }
      cv::Mat grey = mask->pixels;
      if (grey.channels() == 3) cv::cvtColor(grey, grey, cv::COLOR_BGR2GRAY);
      cv::threshold(grey, grey, 127.0, 1.0, cv::THRESH_BINARY);
      return single_object(grey, smallest_hole_);
    }
    if (photo.has_alpha) return single_object(photo.mask, smallest_hole_);
    const auto mask = foreground_of(photo.pixels, threshold_);
    if (!mask) return mask.error();
    return single_object(*mask, smallest_hole_);
  }

  double length_px(const Polygon& outer, int photo_width_px) const {
    if (measured_ == Measured::picture) return photo_width_px;
    Eigen::Vector2d low = outer.front(), high = outer.front();
    double longest = 0.0;
    for (const Eigen::Vector2d& a : outer) {
      weft::worked(static_cast<std::int64_t>(outer.size()));
      low = low.cwiseMin(a);
      high = high.cwiseMax(a);
      for (const Eigen::Vector2d& b : outer) longest = std::max(longest, (a - b).norm());
    }
    if (measured_ == Measured::longest) return longest;
    return measured_ == Measured::width ? high.x() - low.x() : high.y() - low.y();
  }

  /// The spacing for the default number of vertices in a lattice of equilateral triangles, where
  /// none was given.
  double spacing(const Outline& outline, double m_per_px) const {
    if (spacing_mm_ > 0.0) return 0.001 * spacing_mm_ / m_per_px;
    return std::sqrt(2.0 * outline.area_px2() / (std::sqrt(3.0) * vertices_));
  }

  /// In a lattice of equilateral triangles.
  static double vertices_that_fill(const Outline& outline, double spacing_px) {
    return 2.0 * outline.area_px2() / (std::sqrt(3.0) * spacing_px * spacing_px);
  }

  /// Shreds between holes are narrower than the edges, and refined until they are not.
  static Result<void> check_whole(const Outline& outline, const PlaneMesh& mesh,
                                  double spacing_px) {
    const double expected = vertices_that_fill(outline, spacing_px);
    const Eigen::Index made = mesh.flat_px.rows();
    if (static_cast<double>(made) <= kMostRefined * expected + kLeastMesh) return {};
    return Error{Errc::invalid_data,
                 "the object breaks into pieces: " + std::to_string(made) +
                     " vertices were needed where " + std::to_string(std::lround(expected)) +
                     " fill its area, for it is narrower than the mesh's edges between its " +
                     std::to_string(outline.holes.size()) +
                     " holes and at its border: smallest_hole: 1 fills the holes; or give another "
                     "'threshold', a 'mask', or a finer 'spacing_mm'"};
  }

  Result<void> check_spacing(const Outline& outline, double spacing_px, double m_per_px) const {
    const double vertices = vertices_that_fill(outline, spacing_px);
    const std::string parameter = spacing_mm_ > 0.0 ? "'spacing_mm'" : "'vertices'";
    if (vertices < kMostVertices && spacing_px >= 1.0) return {};
    return Error{Errc::invalid_value,
                 parameter + " requires edges of " +
                     std::to_string(1000.0 * spacing_px * m_per_px) + " mm, which is " +
                     std::to_string(spacing_px) +
                     " px of the photograph: make the mesh coarser, at least 1 px, and below " +
                     std::to_string(static_cast<int>(kMostVertices)) + " vertices"};
  }

  static Template assemble(const PlaneMesh& mesh, double m_per_px) {
    Points3 vertices_m = Points3::Zero(mesh.flat_px.rows(), 3);
    vertices_m.leftCols<2>() = m_per_px * mesh.flat_px;
    Template templ;
    templ.vertices_m = make_array<double>(vertices_m);
    templ.flat_px = make_array<double>(mesh.flat_px);
    templ.faces = make_array<std::int32_t>(mesh.faces);
    templ.m_per_px = make_array<double>(Eigen::Vector2d::Constant(m_per_px));
    return templ;
  }

  std::string photo_path_, mask_path_;
  double threshold_ = 0.0;
  double smallest_hole_ = 0.01;
  double length_m_ = 0.0;
  Measured measured_ = Measured::longest;
  double spacing_mm_ = 0.0;
  int vertices_ = 120;
  int smoothing_rounds_ = 10;
};

}  // namespace
}  // namespace weft::outline

using weft::outline::OutlineTemplate;
WEFT_PLUGIN(
    OutlineTemplate, "templates/outline", "1.0.1",
    "Makes a template of a flat object of any outline from a photograph on a plain background.")
