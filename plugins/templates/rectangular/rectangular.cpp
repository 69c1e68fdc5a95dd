// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/data/matrix.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/geometry/surface_size.hpp>
#include <weft/sdk/template_builder.hpp>

#include "common/images/texture_file.hpp"

namespace weft::rectangular {
namespace {

/// Where the corner vertices lie: on the outer edges of the corner texels, or where the file counts
/// texture coordinates from the centre of the top-left texel.
enum class TexelOrigin { edge, centre };

/// A flat rectangular surface that its texture fills. Vertex (i, j) lies at
///     u = i W / (columns - 1) - 1/2,  v = j H / (rows - 1) - 1/2   (px; W x H the texture's size)
/// and at (s_u u, s_v v, 0) in metres, s_u = width / W, s_v = height / H. It does not depend on the
/// camera.
class Rectangular final : public TemplateBuilder {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Shetab-Bushehri et al., ROBUSfT, arXiv:2301.04037 (2023), section on templates"};

  explicit Rectangular(Params& p) {
    p.input_path("texture", texture_path_, "image of the flat surface, from edge to edge",
                 Need::required);
    p.read("width_m", width_m_, "m", {1e-6, 1000.0}, "width of the area that the texture shows",
           Need::required);
    p.read("height_m", height_m_, "m", {0.0, 1000.0}, "height of the surface; 0: square texels");
    p.read("columns", columns_, "", {2, 2000}, "number of vertices along the width");
    p.read("rows", rows_, "", {2, 2000}, "number of vertices along the height");
    p.choice("texel_origin", texel_origin_,
             {{"edge", TexelOrigin::edge}, {"centre", TexelOrigin::centre}},
             "position of texture coordinate 0; edge: outer edge of the first texel; centre: "
             "centre of the first texel");
  }

  void check(Mistakes& mistakes) const {
    mistakes.expect("texture", image_files::check_texture_file("texture", texture_path_));
    mistakes.doubt("width_m", size_doubt(std::max(width_m_, height_m_), "width_m"));
  }

  Result<Template> build(const Call& call) override {
    auto faces = rectangular_grid_faces(columns_, rows_);
    if (!faces) return faces.error();
    auto texture = image_files::read_texture_file("texture", texture_path_);
    if (!texture) return texture.error();
    image_files::report_orientation(call, texture_path_, texture->orientation);

    const cv::Size size = texture->pixels.size();
    const double pitch_u_m = width_m_ / size.width;
    const double pitch_v_m = height_m_ > 0.0 ? height_m_ / size.height : pitch_u_m;
    Template templ = lay_out(size, pitch_u_m, pitch_v_m);
    templ.faces = make_array<std::int32_t>(*faces);
    image_files::store(*texture, templ);
    return templ;
  }

 private:
  /// The grid of vertices, in pixels and in metres.
  Template lay_out(cv::Size size, double pitch_u_m, double pitch_v_m) const {
    const double origin_px = texel_origin_ == TexelOrigin::edge ? -0.5 : 0.0;
    const std::int64_t count = static_cast<std::int64_t>(columns_) * rows_;
    Template templ;
    templ.vertices_m = Array<double>({count, 3});
    templ.flat_px = Array<double>({count, 2});
    templ.m_per_px = Array<double>({2});
    templ.m_per_px(0) = pitch_u_m;
    templ.m_per_px(1) = pitch_v_m;
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        const std::int64_t vertex = static_cast<std::int64_t>(j) * columns_ + i;
        const double u = static_cast<double>(i) * size.width / (columns_ - 1) + origin_px;
        const double v = static_cast<double>(j) * size.height / (rows_ - 1) + origin_px;
        templ.flat_px(vertex, 0) = u;
        templ.flat_px(vertex, 1) = v;
        templ.vertices_m(vertex, 0) = pitch_u_m * u;
        templ.vertices_m(vertex, 1) = pitch_v_m * v;
        templ.vertices_m(vertex, 2) = 0.0;
      }
    }
    return templ;
  }

  std::string texture_path_;
  double width_m_ = 0.0;
  double height_m_ = 0.0;
  int columns_ = 10;
  int rows_ = 10;
  TexelOrigin texel_origin_ = TexelOrigin::edge;
};

}  // namespace
}  // namespace weft::rectangular

using weft::rectangular::Rectangular;
WEFT_PLUGIN(Rectangular, "templates/rectangular", "1.0.0",
            "Makes a regular mesh of a flat rectangular surface that its texture fills.")
