// SPDX-License-Identifier: Apache-2.0
#include "kit/testing/contract_cases.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

#include "kit/testing/contract_materials.hpp"

namespace weft::testing {
namespace {

/// An input that is no usual one, for components that take the slot it is about.
struct Change {
  const char* slot;
  const char* name;
  Expect expect;
  void (*make)(Scene& scene);
};

void show(Scene& scene, std::initializer_list<std::int64_t> shape, std::uint8_t grey) {
  scene.image.pixels = Array<std::uint8_t>(shape);
  std::fill_n(scene.image.pixels.data(), scene.image.pixels.size(), grey);
  if (scene.image.pixels.size() > 0) {
    scene.region.mask =
        Array<std::uint8_t>({scene.image.pixels.dim(0), scene.image.pixels.dim(1)}, 0);
    std::fill_n(scene.region.mask.data(), scene.region.mask.size(), std::uint8_t{1});
    const auto height = scene.image.pixels.dim(0), width = scene.image.pixels.dim(1);
    if (height != scene.camera.height_px || width != scene.camera.width_px) {
      scene.object_mask.foreground = Array<std::uint8_t>({height, width}, 255);
      scene.object_mask.known = Array<std::uint8_t>({height, width}, 1);
    }
  }
}

Keypoints no_keypoints(const Keypoints& like) {
  Keypoints none;
  none.xy_px = Array<double>({0, 2}, 0.0);
  none.scale_px = none.angle_rad = none.response = Array<double>({0}, 0.0);
  none.octave = Array<std::int32_t>({0}, 0);
  none.metric = like.metric;
  none.descriptors = Array<float>({0, like.descriptors.dim(1)}, 0.0F);
  if (like.face.present()) none.face = Array<std::int32_t>({0}, 0);
  if (like.face.present()) none.barycentrics = Array<double>({0, 3}, 0.0);
  return none;
}

void make_alike(Keypoints& keypoints) {
  std::fill_n(keypoints.descriptors.data(), keypoints.descriptors.size(), 7.0F);
}

/// A match that is no mismatch: these come first.
constexpr std::int64_t kGoodMatch = 80;

const Change kChanges[] = {
    {"image", "with a colour image", Expect::answer,
     [](Scene& s) {
       const Array<std::uint8_t> grey = s.image.pixels;
       s.image.pixels = Array<std::uint8_t>({grey.dim(0), grey.dim(1), 3}, 0);
       for (std::int64_t i = 0; i < s.image.pixels.size(); ++i) {
         s.image.pixels.data()[i] = grey.data()[i / 3];
       }
     }},
    {"image", "with an empty image", Expect::any,
     [](Scene& s) {
       show(s, {0, 0}, 0);
     }},
    {"image", "with an image of one pixel", Expect::any,
     [](Scene& s) {
       show(s, {1, 1}, 90);
     }},
    {"image", "with an image without texture", Expect::any,
     [](Scene& s) {
       show(s, {s.camera.height_px, s.camera.width_px}, 128);
     }},
    {"region", "with an empty region", Expect::any,
     [](Scene& s) { std::fill_n(s.region.mask.data(), s.region.mask.size(), std::uint8_t{0}); }},
    {"region", "with a region of another size", Expect::any,
     [](Scene& s) {
       s.region.mask = Array<std::uint8_t>({10, 20}, 0);
     }},
    {"object_mask", "with a mask without foreground", Expect::any,
     [](Scene& s) {
       std::fill_n(s.object_mask.foreground.data(), s.object_mask.foreground.size(),
                   std::uint8_t{0});
     }},
    {"object_mask", "with a mask that is nowhere known", Expect::any,
     [](Scene& s) {
       std::fill_n(s.object_mask.known.data(), s.object_mask.known.size(), std::uint8_t{0});
     }},
    {"object_mask", "with a mask of another size", Expect::any,
     [](Scene& s) {
       s.object_mask.foreground = Array<std::uint8_t>({10, 20}, 255);
       s.object_mask.known = Array<std::uint8_t>({10, 20}, 1);
     }},
    {"keypoints", "with bits for descriptors", Expect::any,
     [](Scene& s) {
       s.keypoints = with_bits(s.keypoints);
       s.template_keypoints = with_bits(s.template_keypoints);
     }},
    {"keypoints", "with descriptors of two kinds", Expect::any,
     [](Scene& s) { s.keypoints = with_bits(s.keypoints); }},
    {"keypoints", "with 0 keypoints in the image", Expect::any,
     [](Scene& s) { s.keypoints = no_keypoints(s.keypoints); }},
    {"template_keypoints", "with 0 keypoints on the template", Expect::any,
     [](Scene& s) { s.template_keypoints = no_keypoints(s.template_keypoints); }},
    {"keypoints", "with one descriptor for all keypoints", Expect::any,
     [](Scene& s) {
       make_alike(s.keypoints);
       make_alike(s.template_keypoints);
     }},
    {"correspondences", "with 0 matches", Expect::warning, [](Scene& s) { s.take_matches({}); }},
    {"correspondences", "with 1 match", Expect::any,
     [](Scene& s) { s.take_matches({kGoodMatch}); }},
    {"correspondences", "with 2 matches", Expect::any,
     [](Scene& s) {
       s.take_matches({kGoodMatch, kGoodMatch + 1});
     }},
    {"correspondences", "with 3 matches on a line", Expect::any,
     [](Scene& s) {
       s.match_vertices({19, 21, 24});
     }},
    {"correspondences", "with all matches the same", Expect::any,
     [](Scene& s) { s.take_matches(std::vector<std::int64_t>(40, kGoodMatch)); }},
    {"correspondences", "with matches that were rejected before", Expect::answer,
     [](Scene& s) {
       for (std::int64_t i = 0; i < s.matches.matches.count(); i += 4)
         s.matches.matches.kept(i) = 0;
       s.follow_matches();
     }},
    {"correspondences", "with no kept match", Expect::warning,
     [](Scene& s) { s.reject_matches(); }},
    {"correspondences", "with no match on the mesh", Expect::any,
     [](Scene& s) { s.leave_the_mesh(); }},
    {"sightlines", "with 0 sightlines", Expect::warning, [](Scene& s) { s.take_matches({}); }},
    {"sightlines", "with 1 sightline", Expect::any, [](Scene& s) { s.take_matches({kGoodMatch}); }},
    {"sightlines", "with 3 sightlines on a line", Expect::any,
     [](Scene& s) {
       s.match_vertices({19, 21, 24});
     }},
    {"sightlines", "with all sightlines the same", Expect::any,
     [](Scene& s) { s.take_matches(std::vector<std::int64_t>(40, kGoodMatch)); }},
    {"sightlines", "with sightlines that count nothing", Expect::warning,
     [](Scene& s) { std::fill_n(s.sightlines.weight.data(), s.sightlines.count(), 0.0); }},
    {"weights", "with weights of 0", Expect::warning,
     [](Scene& s) { std::fill_n(s.weights.weight.data(), s.weights.weight.rows(), 0.0); }},
    {"warp_samples", "with a warp that is valid nowhere", Expect::any,
     [](Scene& s) {
       std::fill_n(s.warp_samples.valid.data(), s.warp_samples.valid.rows(), std::uint8_t{0});
     }},
    {"visibility", "with nothing visible", Expect::any,
     [](Scene& s) {
       s.visibility.visible = Array<std::uint8_t>({s.visibility.visible.rows()}, 0);
       s.visibility.score = Array<double>({s.visibility.visible.rows()}, 0.0);
     }},
};

using Slots = std::set<std::string>;

}  // namespace

std::vector<Input> inputs_of(const Subject& subject, const Scene& scene, const Slots& left_out) {
  std::vector<Input> inputs;
  for (const RoleSlot& slot : subject.rules().main_method().inputs) {
    if (!subject.takes(slot.name) || left_out.count(slot.name) != 0) continue;
    if (HostRecord record = scene.record(slot.name)) inputs.push_back({slot.name, record});
  }
  return inputs;
}

std::vector<Case> cases_of(const Subject& subject) {
  std::vector<Case> cases;
  const auto add = [&](const std::string& name, Expect expect, Scene scene, const Slots& without) {
    auto inputs = inputs_of(subject, scene, without);
    cases.push_back({name, expect, std::move(scene), std::move(inputs)});
  };
  const Scene usual = make_scene(0, subject.seed);
  add("with a usual input", Expect::answer, usual, {});
  add("with another frame", Expect::answer, make_scene(1, subject.seed), {});
  // A component must work without inputs that are absent in the first frame or after a stage
  // without a result.
  Slots optional;
  for (const RoleSlot& slot : subject.rules().main_method().inputs) {
    if (!subject.takes(slot.name) || subject.requires_input(slot.name)) continue;
    const bool of_earlier_frame = slot.name.starts_with("previous.");
    add("without " + slot.name, of_earlier_frame ? Expect::answer : Expect::any, usual,
        {slot.name});
    optional.insert(slot.name);
  }
  if (optional.size() > 1) add("with what it needs alone", Expect::any, usual, optional);
  for (const Change& change : kChanges) {
    if (!subject.takes(change.slot)) continue;
    Scene scene = make_scene(0, subject.seed);  // copies of one share their arrays
    change.make(scene);
    add(change.name, change.expect, std::move(scene), {});
  }
  return cases;
}

}  // namespace weft::testing
