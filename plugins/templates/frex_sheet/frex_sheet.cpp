// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/data/matrix.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/sdk/template_builder.hpp>

#include "sheet_picture.hpp"

namespace weft::frex_sheet {
namespace {

enum class Dictionary { five_by_five, four_by_four };

/// A flat sheet of paper with ArUco markers at random places, as it is printed.
class FrexSheet final : public TemplateBuilder {
 public:
  static constexpr About kAbout{.reference =
                                    "paper: Shetab-Bushehri et al., ROBUSfT, arXiv:2301.04037 "
                                    "(2023), section IV; Garrido-Jurado et "
                                    "al., Pattern Recognition 47 (2014)"};

  explicit FrexSheet(Params& p) {
    p.read("width_mm", spec_.width_mm, "mm", {20.0, 2000.0}, "width of the paper");
    p.read("height_mm", spec_.height_mm, "mm", {20.0, 2000.0}, "height of the paper");
    p.read("count", spec_.count, "", {1, 250}, "number of markers");
    p.read("marker_mm", spec_.marker_mm, "mm", {4.0, 500.0}, "side of a marker");
    p.read("gap_mm", spec_.gap_mm, "mm", {1.0, 500.0}, "minimum white gap between two markers");
    p.read("margin_mm", spec_.margin_mm, "mm", {0.0, 500.0},
           "minimum white margin along the edges");
    p.read("seed", spec_.seed, "", {0, 1e15}, "seed of the marker positions");
    p.choice("dictionary", dictionary_,
             {{"5x5_250", Dictionary::five_by_five}, {"4x4_250", Dictionary::four_by_four}},
             "ArUco dictionary");
    p.read("px_per_mm", px_per_mm_, "px/mm", {1, 40}, "resolution of the texture; 12 is 304.8 dpi");
    p.read("columns", columns_, "", {2, 2000}, "number of vertices along the width");
    p.read("rows", rows_, "", {2, 2000}, "number of vertices along the height");
  }

  void check(Mistakes& mistakes) const {
    mistakes.expect("count", lay_out());
    mistakes.expect("px_per_mm", check_size());
  }

  Result<Template> build(const Call&) override {
    const auto sheet = lay_out();
    if (!sheet) return sheet.error();
    if (auto legal = check_size(); !legal) return legal.error();
    const auto picture = draw_sheet(*sheet, px_per_mm_);
    if (!picture) return picture.error();
    const auto faces = rectangular_grid_faces(columns_, rows_);
    if (!faces) return faces.error();
    return assemble(*picture, *faces);
  }

 private:
  static constexpr double kMostTexels = 2e8;

  Result<MarkerSheet> lay_out() const {
    MarkerSheetSpec spec = spec_;
    spec.dictionary = dictionary_ == Dictionary::four_by_four ? "4x4_250" : "5x5_250";
    return lay_out_markers(spec);
  }

  Result<void> check_size() const {
    const double texels = static_cast<double>(spec_.width_mm) * spec_.height_mm;
    if (texels * px_per_mm_ * px_per_mm_ <= kMostTexels) return {};
    return Error{Errc::invalid_value, "the texture would be too large: lower 'px_per_mm'"};
  }

  Template assemble(const cv::Mat& picture, const Faces& faces) const {
    const double pitch_m = 0.001 / px_per_mm_;
    Points2 flat_px(static_cast<Eigen::Index>(columns_) * rows_, 2);
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        flat_px.row(static_cast<Eigen::Index>(j) * columns_ + i)
            << static_cast<double>(i) * picture.cols / (columns_ - 1) - 0.5,
            static_cast<double>(j) * picture.rows / (rows_ - 1) - 0.5;
      }
    }
    Points3 vertices_m = Points3::Zero(flat_px.rows(), 3);
    vertices_m.leftCols<2>() = pitch_m * flat_px;

    Template templ;
    templ.vertices_m = make_array<double>(vertices_m);
    templ.flat_px = make_array<double>(flat_px);
    templ.faces = make_array<std::int32_t>(faces);
    templ.m_per_px = make_array<double>(Eigen::Vector2d::Constant(pitch_m));
    templ.texture = Array<std::uint8_t>({picture.rows, picture.cols});
    picture.copyTo(cv::Mat(picture.size(), CV_8U, templ.texture.data()));
    templ.mask = Array<std::uint8_t>({picture.rows, picture.cols}, 1);
    return templ;
  }

  MarkerSheetSpec spec_;
  Dictionary dictionary_ = Dictionary::five_by_five;
  int px_per_mm_ = 12;
  int columns_ = 31;
  int rows_ = 22;
};

}  // namespace
}  // namespace weft::frex_sheet

using weft::frex_sheet::FrexSheet;
WEFT_PLUGIN(
    FrexSheet, "templates/frex_sheet", "1.0.0",
    "Makes a sheet of paper with ArUco markers at random positions, for printing and filming.")
