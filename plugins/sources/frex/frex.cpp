// SPDX-License-Identifier: Apache-2.0
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/template_builder.hpp>

#include "common/images/picture_file.hpp"
#include "film/film_source.hpp"
#include "handle_pair.hpp"
#include "print.hpp"
#include "rest_sheet.hpp"
#include "samples/sample_source.hpp"
#include "settings.hpp"
#include "sheet_film.hpp"
#include "solid/solid_film.hpp"
#include "solid/solid_rest.hpp"

namespace weft::frex {
namespace {

/// A simulated textured surface.
class SheetSource : public FilmSource {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Shetab-Bushehri et al., ROBUSfT (2023), section IV; XPBD: Macklin et al. 2016",
      .produces = "image time ground_truth object_mask"};

 protected:
  /// Reads the parameters that all surfaces have.
  void read_settings(Params& p) {
    settings_.read(p, [&](Params& between) { pattern_.read(between); });
  }

  Result<Subject> film(scene::MipTexture print, const RestSheet& sheet) const {
    auto film = SheetFilm::create(pattern_.with(settings_.sways), sheet, settings_.fps);
    if (!film) return film.error();
    return Subject{std::move(print),   sheet.uv_px, sheet.pitch_m,   sheet.faces,
                   sheet.uv_px.rows(), sheet.faces, *std::move(film)};
  }

 private:
  PatternSettings pattern_;
};

/// A rectangular surface that its texture fills.
class Frex final : public SheetSource {
 public:
  explicit Frex(Params& p) {
    rectangle_.read(p);
    read_settings(p);
  }

  void check(Mistakes& mistakes) const {
    mistakes.expect("texture", image_files::check_picture("texture", rectangle_.texture_path));
    FilmSource::check(mistakes);
  }

 private:
  Result<Subject> make_subject(const Call&) const override {
    const auto picture = image_files::read_picture("texture", rectangle_.texture_path);
    if (!picture) return picture.error();
    scene::MipTexture print(*picture);
    auto sheet = rectangle(print, rectangle_.width_m, rectangle_.height_m, rectangle_.columns,
                           rectangle_.rows);
    if (!sheet) return sheet.error();
    return film(std::move(print), *sheet);
  }

  RectangleSettings rectangle_;
};

/// The object of a template: of any outline, flat or curved at rest.
class FrexObject final : public SheetSource {
 public:
  explicit FrexObject(Params& p) {
    p.component("object", object_,
                "template of the filmed object; a mesh finer than the tracked one gives finer "
                "ground truth");
    read_settings(p);
  }

 private:
  Result<Subject> make_subject(const Call& call) const override {
    const auto templ = object_.build(call);
    if (!templ) return templ.error();
    auto sheet = sheet_of(*templ);
    if (!sheet) return sheet.error();
    return film(print_of(*templ), *sheet);
  }

  TemplateComponent object_{"templates/outline"};
};

/// A solid object that a map of space deforms.
class FrexVolume final : public FilmSource {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Rivlin, Large elastic deformations of isotropic materials V: the problem "
          "of flexure (1949)",
      .produces = "image time ground_truth object_mask"};

  explicit FrexVolume(Params& p) {
    p.component("object", object_, "template of the filmed object, usually a closed surface");
    p.read("edge_m", edge_m_, "m", {0.0, 1000.0},
           "longest edge of the rendered mesh, in which faces are divided; 0: a fortieth of the "
           "diagonal of the object");
    p.read("view_rad", view_rad_, "rad", {-4.0, 4.0},
           "rotation vector of the object in the first frame, from its largest side facing the "
           "camera");
    settings_.read(p, [&](Params& between) { read_deformation(between); });
  }

  void check(Mistakes& mistakes) const {
    mistakes.expect("view_rad", check_view());
    FilmSource::check(mistakes);
  }

 private:
  void read_deformation(Params& p) {
    p.choice(
        "motion", deformation_.motion,
        {{"bend", SolidMotion::bend}, {"twist", SolidMotion::twist}, {"press", SolidMotion::press}},
        "deformation, which keeps the volume; bend: about the middle side; twist: about the "
        "longest side; press: by two fingers along the shortest side");
    p.read("angle_rad", deformation_.angle_rad, "rad", {0.0, 3.15},
           "largest angle between both ends; for motion: bend and twist");
    p.read("press_share", deformation_.press_share, "", {0.0, 0.8},
           "largest compression between the fingers; for motion: press");
  }

  Result<void> check_view() const {
    if (view_rad_.size() == 3) return {};
    return Error{Errc::invalid_value, "'view_rad' has " + std::to_string(view_rad_.size()) +
                                          " numbers: give a rotation vector of 3"};
  }

  Result<Subject> make_subject(const Call& call) const override {
    if (auto legal = check_view(); !legal) return legal.error();
    const auto templ = object_.build(call);
    if (!templ) return templ.error();
    const auto rest = solid_of(*templ, edge_m_);
    if (!rest) return rest.error();
    const Eigen::Matrix3d view = rotation_of({view_rad_[0], view_rad_[1], view_rad_[2]});
    auto film = SolidFilm::create(deformation_, settings_.sways, *rest, view, settings_.fps);
    if (!film) return film.error();
    const RefinedSurface& surface = rest->surface;
    return Subject{print_of(*templ),     surface.uv_px,       rest->pitch_m,   surface.faces,
                   surface.truth_points, surface.truth_faces, *std::move(film)};
  }

  TemplateComponent object_{"templates/mesh"};
  double edge_m_ = 0.0;
  std::vector<double> view_rad_{0.5, 0.4, 0.1};
  SpaceMap::Settings deformation_;
};

}  // namespace
}  // namespace weft::frex

using weft::frex::Frex;
using weft::frex::FrexObject;
using weft::frex::FrexVolume;
using weft::frex::SampleSource;
WEFT_LIBRARY(
    WEFT_COMPONENT(Frex, "sources/frex", "1.0.0",
                   "Simulates a printed sheet of paper or cloth in front of a camera, with dense "
                   "exact ground truth."),
    WEFT_COMPONENT(
        FrexObject, "sources/frex_object", "1.0.0",
        "Simulates a flat or curved object, given as a template, in the same way as sources/frex."),
    WEFT_COMPONENT(FrexVolume, "sources/frex_volume", "1.0.0",
                   "Films a solid object, given as a template, that is bent, twisted or pressed "
                   "without a change of its volume, with exact ground truth on all sides."),
    WEFT_COMPONENT(SampleSource, "sources/frex_samples", "1.0.0",
                   "Draws independent images of a flat object, each with its own shape, pose, "
                   "light, background, occluders and blur, for training and testing networks."))
