// SPDX-License-Identifier: Apache-2.0
#include "samples/sample_source.hpp"

#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>

#include "common/scene/random_stream.hpp"
#include "print.hpp"
#include "rest_sheet.hpp"
#include "samples/occluders.hpp"

namespace weft::frex {
namespace {

constexpr std::uint64_t kSampleStream = 11;

/// Fails unless all vertices lie in a plane.
Result<void> check_flat(const RestSheet& sheet) {
  constexpr double kFlat = 1e-6;  // as a share of the largest coordinate
  const double deep_m = sheet.rest_m.col(2).maxCoeff() - sheet.rest_m.col(2).minCoeff();
  if (sheet.is_unrolled && deep_m <= kFlat * sheet.rest_m.cwiseAbs().maxCoeff()) return {};
  return Error{Errc::invalid_data,
               "the object is not flat at rest: give a flat template, or use sources/frex_object"};
}

}  // namespace

SampleSource::SampleSource(Params& p) {
  p.component("object", object_, "template of the object, flat at rest");
  p.read("frames", frames_, "", {1, 100000000}, "number of frames");
  p.read("image_width_px", camera_.width_px, "px", {16, 8192}, "width of the images");
  p.read("image_height_px", camera_.height_px, "px", {16, 8192}, "height of the images");
  p.read("focal_px", camera_.fx, "px", {1.0, 100000.0}, "focal length");
  p.read("nearest", shapes_.nearest, "", {0.1, 100.0},
         "least distance; at 1 the width of the object fills the image");
  p.read("farthest", shapes_.farthest, "", {0.1, 100.0}, "largest distance, in the same unit");
  p.read("tilt_rad", shapes_.tilt_rad, "rad", {0.0, 1.5},
         "standard deviation of the tilt, which is at most 60 degrees");
  p.read("roll_rad", shapes_.roll_rad, "rad", {0.0, 3.2},
         "standard deviation of the turn about the optical axis");
  p.read("bend", shapes_.bend, "", {0.0, 1.5},
         "size of the deformation, relative to the usual one");
  p.read("empty_share", empty_share_, "", {0.0, 1.0}, "share of frames without the object");
  p.read("occluders", occluders_, "", {0, 20}, "largest number of things before the object");
  p.input_path("backgrounds", backgrounds_,
               "folder of photographs that serve as backgrounds, beside simulated tables");
  p.read("light", looks_.light, "", {0.0, 1.0},
         "size of the changes of light, relative to the usual ones");
  p.read("blur_px", looks_.blur_px, "px", {0.0, 20.0},
         "largest standard deviation of the lens blur");
  p.read("motion_blur_px", looks_.motion_blur_px, "px", {0.0, 100.0},
         "largest length of the motion blur");
  p.read("noise_grey", looks_.noise_grey, "grey level", {0.0, 255.0},
         "largest standard deviation of the pixel noise");
  p.read("dense_truth", dense_truth_, "depth and template point of each pixel in the ground truth");
  p.read("seed", seed_, "", {0, 9007199254740992.0}, "seed, independent of the run's seed");
}

void SampleSource::check(Mistakes& mistakes) const {
  mistakes.expect("nearest", check_distances());
}

Result<void> SampleSource::check_distances() const {
  if (shapes_.nearest <= shapes_.farthest) return {};
  return Error{Errc::invalid_value, "'nearest' is larger than 'farthest': exchange them"};
}

Result<Camera> SampleSource::open(const Call& call) {
  if (auto legal = check_distances(); !legal) return legal.error();
  camera_.fy = camera_.fx;
  camera_.cx = 0.5 * static_cast<double>(camera_.width_px - 1);
  camera_.cy = 0.5 * static_cast<double>(camera_.height_px - 1);
  const auto templ = object_.build(call);
  if (!templ) return templ.error();
  const auto sheet = sheet_of(*templ);
  if (!sheet) return sheet.error();
  if (auto flat = check_flat(*sheet); !flat) return flat.error();
  scene::MipTexture print = print_of(*templ);
  auto scenery = Scenery::create(camera_, backgrounds_, static_cast<std::uint64_t>(seed_));
  if (!scenery) return scenery.error();
  Picture black{static_cast<int>(camera_.width_px), static_cast<int>(camera_.height_px)};
  black.pixels.resize(to_index(camera_.width_px * camera_.height_px), scene::Colour::Zero());
  auto renderer = scene::SheetRenderer::create(camera_, std::move(print), sheet->uv_px,
                                               sheet->faces, std::move(black));
  if (!renderer) return renderer.error();
  const Points2 flat_m = sheet->flat_m();
  studio_.emplace(Studio{*std::move(renderer),
                         {camera_.fx, camera_.fy, camera_.cx, camera_.cy},
                         RandomSheet(shapes_, flat_m, camera_),
                         *std::move(scenery),
                         Looks(looks_),
                         {make_array<double>(flat_m), make_array<std::int32_t>(sheet->faces),
                          sheet->pitch_m, dense_truth_}});
  return camera_;
}

Result<SourceFrame> SampleSource::read(std::int64_t index, const Call&) {
  if (!studio_) return Error{Errc::invalid_value, "the source is not open: open it first"};
  if (index < 0 || index >= frames_) {
    return Error{Errc::invalid_value, "there is no frame " + std::to_string(index) +
                                          ": the source has " + std::to_string(frames_) +
                                          ", counted from 0"};
  }
  Rng rng = scene::random_stream(static_cast<std::uint64_t>(seed_), kSampleStream,
                                 static_cast<std::uint64_t>(index));
  const bool is_there = rng.uniform() >= empty_share_;
  const Points3 vertices_m = studio_->sheet.draw(rng);
  scene::View view = look(vertices_m, is_there, rng);
  studio_->looks.relight(view.coverage, rng, view.image);
  SourceFrame frame;
  frame.ground_truth = truth_of(studio_->truth, vertices_m, view);
  frame.image = Image{};
  frame.image->stem = std::to_string(index);
  frame.image->pixels = studio_->looks.expose(view.image, rng);
  return frame;
}

/// The object over a background, under things. Where it is not there, the things still are.
scene::View SampleSource::look(const Points3& vertices_m, bool is_there, Rng& rng) {
  // Most images have no occluder, the fewest have all.
  const double share = rng.uniform();
  const int things = static_cast<int>(share * share * (occluders_ + 1));
  const scene::Light lamp = studio_->looks.lamp(rng);
  scene::View view =
      is_there ? studio_->renderer.render(vertices_m, lamp) : studio_->renderer.render_nothing();
  const Picture behind = studio_->scenery.draw(rng);
  ask_to_go_on();
  for (std::size_t k = 0; k < behind.pixels.size(); ++k) {
    view.image.pixels[k] += (1.0F - view.coverage.data()[k]) * behind.pixels[k];
  }
  if (things > 0) {
    const Picture textured = studio_->scenery.draw(rng);
    cover_at_random(things, textured, project_points(studio_->pinhole, vertices_m), rng, view);
  }
  return view;
}

}  // namespace weft::frex
