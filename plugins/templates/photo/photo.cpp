// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/geometry/surface_size.hpp>
#include <weft/sdk/detector.hpp>
#include <weft/sdk/template_builder.hpp>

#include "common/cameras/lens_points.hpp"
#include "common/images/picture_file.hpp"
#include "common/images/texture_file.hpp"
#include "corner_page.hpp"
#include "corner_picture.hpp"
#include "mesh_size.hpp"
#include "photograph.hpp"
#include "rectified.hpp"
#include "sheet_finder.hpp"
#include "sheet_view.hpp"

namespace weft::photo {
namespace {

constexpr double kDegree = M_PI / 180.0;

/// The place of the surface in the photograph, and its size.
struct Sheet {
  Corners corners_px;  ///< ideal px
  SheetView view;
  double width_m = 0.0, height_m = 0.0;
  std::vector<std::string> notes;  ///< warnings
};

/// A flat rectangular surface from one photograph of it. The builder finds the corners, computes
/// the height by the camera, and takes the area between the corners as the texture. Vertices are at
/// s (u, v, 0) as those of templates/rectangular.
class PhotoTemplate final : public TemplateBuilder {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Zhang and He, Whiteboard scanning and image enhancement, Digital Signal Processing "
          "17(2) (2007); Grompone von Gioi et al., LSD: a line segment detector, IPOL 2 (2012)"};

  explicit PhotoTemplate(Params& p) {
    p.input_path("photo", photo_path_, "photograph of the whole surface, flat", Need::required);
    p.read("width_m", width_m_, "m", {1e-6, 1000.0}, "width of the surface in reading orientation",
           Need::required);
    p.input_path("camera", camera_path_,
                 "camera file: Weft's own (YAML or JSON), OpenCV's YAML or ROS camera_info; "
                 "without it the focal length is guessed");
    p.read("height_m", height_m_, "m", {0.0, 1000.0},
           "height of the surface; 0: derived from the corners and the camera");
    p.read("corners", corners_, "px", {},
           "x, y of the top left, top right, bottom right and bottom left corner in the "
           "photograph; empty: detected");
    p.read("columns", columns_, "", {0, kMostAlongSide},
           "number of vertices along the width; 0: proposed automatically");
    p.read("rows", rows_, "", {0, kMostAlongSide},
           "number of vertices along the height; 0: proposed automatically");
    p.read("texture_px", texture_px_, "px", {0, 8192},
           "longer side of the texture; 0: as in the photograph, at most 1600");
    p.component("detector", detector_,
                "detector whose keypoints determine the resolution of a proposed mesh");
    p.output_path("drawing", drawing_path_, "PNG file of the photograph with corners and mesh");
    p.output_path("corners_page", page_path_,
                  "HTML page for moving the corners by hand, written even if none are found");
  }

  void check(Mistakes& mistakes) const {
    mistakes.expect("photo", image_files::check_picture("photo", photo_path_));
    if (!camera_path_.empty()) {
      mistakes.expect("camera", cameras::read_camera_file(camera_path_));
    }
    mistakes.expect("corners", check_count());
    mistakes.expect(columns_ == 1 ? "columns" : "rows", check_grid());
    mistakes.doubt("width_m", size_doubt(std::max(width_m_, height_m_), "width_m"));
  }

  Result<Template> build(const Call& call) override {
    if (auto legal = check_count(); !legal) return legal.error();
    if (auto legal = check_grid(); !legal) return legal.error();
    auto photo = read_photograph(photo_path_, camera_path_);
    if (!photo) return photo.error();
    image_files::report_orientation(call, photo_path_, photo->orientation);
    const auto found = sheet_in(*photo);
    if (auto offered = offer_page(*photo, found); !offered) return offered.error();
    if (!found) return found.error();
    auto sheet = sheet_at(found->corners_px, *photo);
    if (!sheet) return sheet.error();
    if (found->border_side) sheet->notes.push_back(at_border(*found->border_side));
    const auto size_px = texture_size(*sheet);
    if (!size_px) return size_px.error();
    const cv::Mat texture = rectified(*photo, sheet->view.px_from_unit, *size_px);
    const auto grid = grid_for(call, texture);
    if (!grid) return grid.error();
    auto templ = lay_out(*sheet, *grid, texture);
    if (!templ) return templ.error();
    if (auto drawn = draw(*photo, *sheet, *grid); !drawn) return drawn.error();
    if (sheet->notes.empty()) return templ;
    return degenerate(*std::move(templ),
                      in_photo(fmt::format("{}", fmt::join(sheet->notes, "; "))));
  }

 private:
  static constexpr double kMostTilt_rad = 65.0 * kDegree;  // below 0.42 of the texels are seen
  static constexpr double kMostSkew_rad = 2.0 * kDegree, kMostDisagreement = 0.02;
  static constexpr double kMostTexture_px = 1600.0;  // more than any camera shows of it
  static constexpr int kLeastTexture_px = 32;

  std::string in_photo(const std::string& message) const { return photo_path_ + ": " + message; }
  Error wrong(const std::string& message) const {
    return {Errc::invalid_data, in_photo(message), {}};
  }

  Result<void> check_count() const {
    if (corners_.empty() || corners_.size() == 8) return {};
    return Error{Errc::invalid_value,
                 fmt::format("'corners' has {} numbers and needs 8: x and y of the top left, top "
                             "right, bottom right and bottom left corner",
                             corners_.size())};
  }

  Result<void> check_grid() const {
    if (columns_ != 1 && rows_ != 1) return {};
    return Error{Errc::invalid_value,
                 "a side of the mesh has 2 vertices or more; 0 lets them be proposed"};
  }

  /// Without a camera, where it finds no straight sides, it tries lenses that bend them. It takes a
  /// surface with more parts hidden by hands or by the photograph's border only in two cases.
  /// Either there is no other, or the other is far smaller: a frame that is printed on it.
  Result<FoundSheet> found_sheet(Photograph& photo) const {
    constexpr double kFarMore = 1.5, kMore = 1.2;
    auto found = find_sheet(photo);
    Photograph straight = photo;
    for (const double k1 : {-0.1, -0.2, 0.1}) {
      if (found || photo.is_calibrated) break;
      photo.camera.model = cameras::Distortion::brown;
      photo.camera.coefficients = {k1, 0.0, 0.0, 0.0, 0.0};
      if (auto bent = find_sheet(photo)) found = std::move(bent);
    }
    const auto is_larger = [](const Result<FoundSheet>& a, const Result<FoundSheet>& b,
                              double times) {
      return a && (!b || signed_area_px2(a->corners_px) > times * signed_area_px2(b->corners_px));
    };
    const auto in_hands = find_sheet(straight, Missing::to_hands);
    if (found && !is_larger(in_hands, found, kFarMore)) return found;
    photo = std::move(straight);
    auto at_border = find_sheet(photo, Missing::one_side);
    if (is_larger(at_border, in_hands, kMore)) return at_border;
    return in_hands ? in_hands : wrong(found.error().message);
  }

  /// Uses the given corners, or finds them.
  Result<FoundSheet> sheet_in(Photograph& photo) const {
    if (corners_.empty()) return found_sheet(photo);
    Points2 points_px(4, 2);
    Corners given;
    for (std::size_t k = 0; k < 4; ++k) {
      given[k] = {corners_[2 * k], corners_[2 * k + 1]};
      points_px.row(static_cast<Eigen::Index>(k)) = given[k].transpose();
      if (photo.camera.camera.shows(given[k].x(), given[k].y())) continue;
      return wrong(fmt::format(
          "the {} corner at ({}, {}) px lies outside of the photograph, {} x {} px: correct "
          "'corners'",
          name_of_corner(k), given[k].x(), given[k].y(), photo.pixels.cols, photo.pixels.rows));
    }
    auto legal = check_corners(given);
    if (!legal) return wrong("'corners': " + legal.error().message);
    legal = cameras::undistort_points(photo.camera, in_photo("the corner at"), points_px);
    if (!legal) return legal.error();
    for (std::size_t k = 0; k < 4; ++k) {
      given[k] = points_px.row(static_cast<Eigen::Index>(k)).transpose();
    }
    legal = check_corners(given);
    if (!legal) return wrong("'corners' without distortion: " + legal.error().message);
    return FoundSheet{given, std::nullopt};
  }

  static std::string at_border(std::size_t side) {
    constexpr std::array<const char*, 4> kNames{"upper", "right", "lower", "left"};
    const char* effect = side % 2 == 0 ? "the template lacks what is beyond"
                                       : "give as 'width_m' the width of what is seen";
    return fmt::format(
        "the {} side of the object is the border of the photograph: if the object continues beyond "
        "it, {}",
        kNames[side], effect);
  }

  /// It is wanted most where there are no corners.
  Result<void> offer_page(const Photograph& photo, const Result<FoundSheet>& found) const {
    const auto known_px = found ? std::optional(found->corners_px) : std::nullopt;
    return page_path_.empty() ? Result<void>() : write_corner_page(photo, known_px, page_path_);
  }

  /// Sets the focal length of a photograph that has no camera.
  Result<Sheet> sheet_at(const Corners& corners_px, Photograph& photo) const {
    Sheet sheet;
    sheet.corners_px = corners_px;
    FocalGuess guess;
    if (!photo.is_calibrated) {
      guess = guess_focal_length(corners_px, photo.pinhole());
      set_focal_length(photo.camera, guess.focal_px);
    }
    sheet.view = view_of_sheet(corners_px, photo.pinhole());
    if (sheet.view.tilt_rad > kMostTilt_rad) {
      return wrong(
          fmt::format("the object is seen {:.0f} degrees from straight above, too obliquely for a "
                      "texture: take it from above, within {:.0f} degrees",
                      sheet.view.tilt_rad / kDegree, kMostTilt_rad / kDegree));
    }
    sheet.width_m = width_m_;
    const double seen_height_m = width_m_ * sheet.view.height_over_width;
    sheet.height_m = height_m_ > 0.0 ? height_m_ : seen_height_m;
    if (!photo.is_calibrated) sheet.notes.push_back(without_camera(guess, sheet.height_m));
    if (std::abs(sheet.view.skew_rad) > kMostSkew_rad) {
      sheet.notes.push_back(
          fmt::format("the corners are {:.1f} degrees off right angles for this camera: check that "
                      "the object is flat, and that the camera belongs to this photograph",
                      std::abs(sheet.view.skew_rad) / kDegree));
    }
    const double error = std::abs(std::log(sheet.height_m / seen_height_m));
    if (photo.is_calibrated && error > kMostDisagreement) {
      sheet.notes.push_back(fmt::format(
          "'height_m' is {:.4g}, but by corners and camera it is {:.4g}: measure both sides again",
          height_m_, seen_height_m));
    }
    return sheet;
  }

  /// Keeps the distortion of the lens.
  static void set_focal_length(cameras::CameraFile& file, double focal_px) {
    const double ratio = focal_px / file.camera.fx;
    if (!file.coefficients.empty()) file.coefficients[0] *= ratio * ratio;
    file.camera.fx = file.camera.fy = focal_px;
  }

  std::string without_camera(const FocalGuess& guess, double height_m) const {
    if (height_m_ > 0.0) {
      return "not calibrated: without 'camera' what the lens bends may be bent in the texture";
    }
    return fmt::format(
        "not calibrated: without 'camera' the focal length is guessed to be {:.0f} px, and the "
        "height, {:.1f} mm, may be off by {:.1f} %: give 'height_m' or 'camera'",
        guess.focal_px, 1000.0 * height_m, 100.0 * guess.ratio_error);
  }

  /// As fine as the photograph shows the surface where it appears largest.
  Result<cv::Size> texture_size(const Sheet& sheet) const {
    const Corners& p = sheet.corners_px;
    const double across_px = std::max((p[1] - p[0]).norm(), (p[2] - p[3]).norm());
    const double down_px = std::max((p[3] - p[0]).norm(), (p[2] - p[1]).norm());
    const double longer_m = std::max(sheet.width_m, sheet.height_m);
    const double seen_px = longer_m * std::max(across_px / sheet.width_m, down_px / sheet.height_m);
    const double longer_px = texture_px_ > 0 ? texture_px_ : std::min(seen_px, kMostTexture_px);
    const cv::Size size(static_cast<int>(std::lround(sheet.width_m * longer_px / longer_m)),
                        static_cast<int>(std::lround(sheet.height_m * longer_px / longer_m)));
    if (std::min(size.width, size.height) >= kLeastTexture_px) return size;
    return wrong(
        fmt::format("the object, {:.4g} x {:.4g} m, would have a texture of {} x {} px, below {} "
                    "px: check 'width_m', 'height_m' and 'corners'{}, or take it larger",
                    sheet.width_m, sheet.height_m, size.width, size.height, kLeastTexture_px,
                    texture_px_ > 0 ? ", raise 'texture_px'" : ""));
  }

  Result<Grid> grid_for(const Call& call, const cv::Mat& texture) const {
    const double ratio = static_cast<double>(texture.rows) / texture.cols;
    if (columns_ > 0 && rows_ > 0) return Grid{columns_, rows_};
    if (columns_ > 0) return Grid{columns_, vertices_for_squares(columns_, ratio)};
    if (rows_ > 0) return Grid{vertices_for_squares(rows_, 1.0 / ratio), rows_};
    cv::Mat viewed = texture;
    const double scale = static_cast<double>(kViewed_px) / std::max(texture.cols, texture.rows);
    if (scale < 1.0) cv::resize(texture, viewed, {}, scale, scale, cv::INTER_AREA);
    const std::int64_t width = viewed.cols, height = viewed.rows;
    DetectorInput in{call};
    in.image.stem = "texture";
    in.image.pixels = viewed.channels() == 1 ? Array<std::uint8_t>({height, width})
                                             : Array<std::uint8_t>({height, width, 3});
    viewed.copyTo(cv::Mat(viewed.size(), viewed.type(), in.image.pixels.data()));
    const auto keypoints = detector_.detect(in);
    if (!keypoints && keypoints.error().code != Errc::no_result) return keypoints.error();
    return proposed_grid(keypoints ? keypoints->count() : 0, ratio);
  }

  static Result<Template> lay_out(const Sheet& sheet, const Grid& grid, const cv::Mat& texture) {
    const auto faces = rectangular_grid_faces(grid.columns, grid.rows);
    if (!faces) return faces.error();
    const Points2 flat_px =
        rectangular_grid_px(grid.columns, grid.rows, texture.cols, texture.rows);
    const Eigen::Vector2d m_per_px(sheet.width_m / texture.cols, sheet.height_m / texture.rows);
    Points3 vertices_m = Points3::Zero(flat_px.rows(), 3);
    vertices_m.leftCols<2>() = flat_px * m_per_px.asDiagonal();
    Template templ;
    templ.vertices_m = make_array<double>(vertices_m);
    templ.flat_px = make_array<double>(flat_px);
    templ.faces = make_array<std::int32_t>(*faces);
    templ.m_per_px = make_array<double>(m_per_px);
    Points2 corners_px(4, 2);
    for (std::size_t k = 0; k < 4; ++k) {
      corners_px.row(static_cast<Eigen::Index>(k)) = sheet.corners_px[k].transpose();
    }
    templ.others.set("x.weft.corners_px", make_array<double>(corners_px));
    image_files::store({texture, cv::Mat::ones(texture.size(), CV_8U)}, templ);
    return templ;
  }

  Result<void> draw(const Photograph& photo, const Sheet& sheet, const Grid& grid) const {
    if (drawing_path_.empty()) return {};
    const std::string size =
        fmt::format("{:.1f} x {:.1f} mm", 1000.0 * sheet.width_m, 1000.0 * sheet.height_m);
    return write_corner_picture(
        photo, {sheet.corners_px, sheet.view.px_from_unit, grid.columns, grid.rows, size},
        drawing_path_);
  }

  std::string photo_path_, camera_path_, drawing_path_, page_path_;
  double width_m_ = 0.0, height_m_ = 0.0;
  std::vector<double> corners_;
  int columns_ = 0, rows_ = 0, texture_px_ = 0;
  DetectorComponent detector_{"detectors/sift_fast"};
};

}  // namespace
}  // namespace weft::photo

using weft::photo::PhotoTemplate;
WEFT_PLUGIN(PhotoTemplate, "templates/photo", "1.0.0",
            "Makes a template of a flat rectangular surface from a photograph.")
