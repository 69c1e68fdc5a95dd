// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <weft/data/matrix.hpp>

#include "kit/testing/geometry/answers.hpp"
#include "kit/testing/geometry/bounds.hpp"
#include "kit/testing/geometry/check_geometry.hpp"

namespace weft::testing {
namespace {

bool takes_matches(const Subject& subject) {
  return subject.takes("correspondences") || subject.takes("sightlines") ||
         subject.takes("keypoints");
}

/// The reason why a scene moved in this way does not test the component; empty if it does.
std::string why_not(const Subject& subject, const Move& move) {
  if (!move.matches.empty() && !takes_matches(subject)) return "it is given no matches";
  if (!move.matches.empty() && subject.is_random()) {
    return "it draws matches by their numbers, which are others then";
  }
  if (move.moves_image() && sees_pixels(subject)) {
    return "it reads pixels, whose grid does not move along with what they show";
  }
  return "";
}

/// Both copies of a match have the same verdict.
std::string twins_differ(const Asked& asked, const Move& move) {
  const auto mask = asked.answer.get<InlierMask>("inlier_mask");
  std::int64_t differ = 0;
  for (std::int64_t i = 0; i < mask->kept.rows(); ++i) {
    differ += mask->kept(i) != mask->kept(move.match(i)) ? 1 : 0;
  }
  return differ == 0 ? "" : "of " + std::to_string(differ) + " matches one copy is kept";
}

/// A tenth of the matches counts twice, which may move the answer by about a tenth of its error.
std::string change_of_answer(const Scene& scene, const Asked& before, const Asked& after) {
  constexpr double kShare = 0.1;
  const auto was = before.answer.get<Shape>("shape"), is = after.answer.get<Shape>("shape");
  if (was && is) {
    const double change_m = mean_distance(is->vertices_m.matrix<3>(), was->vertices_m.matrix<3>());
    if (change_m <= kShare * shape_bound_m(scene.templ)) return "";
    return "its shape changes by " + std::to_string(1000.0 * change_m) + " mm in the mean";
  }
  if (!before.warped_px || !after.warped_px) return "it gives no answer then";
  const double change_px = mean_distance(*after.warped_px, *before.warped_px);
  if (change_px <= kShare * kMatchBound_px) return "";
  return "its warp changes by " + std::to_string(change_px) + " px in the mean";
}

void check_twice(const Subject& subject, const Scene& scene, const Asked& before, Checks& checks) {
  const Move move = repeat_matches(scene);
  checks.begin(move.name);
  const RoleRules& rules = subject.rules();
  if (const std::string why = why_not(subject, move); !why.empty() && !rules.marks) {
    return checks.does_not_apply(why);
  }
  if (!rules.marks && !rules.solves && !rules.samples) {
    return checks.does_not_apply("its answer contains no matches and no shape");
  }
  const Asked after = ask(subject, moved(scene, move), inner_texels(scene.templ));
  if (!after.answer.is_usable()) return checks.fail("reports " + to_text(after.answer));
  const std::string how =
      rules.marks ? twins_differ(after, move) : change_of_answer(scene, before, after);
  checks.expect(how.empty(), how);
}

void check_move(const Subject& subject, const Scene& scene, const Asked& before, const Move& move,
                Checks& checks) {
  checks.begin(move.name);
  if (const std::string why = why_not(subject, move); !why.empty()) {
    return checks.does_not_apply(why);
  }
  const auto along = subject.in_units(move.pixels(), move.metres);
  if (!along) return checks.does_not_apply("in these units " + along.error().message);
  const Points2 texels_px = moved_texels(scene.templ, inner_texels(scene.templ), move);
  const Asked after = ask(*along, moved(scene, move), texels_px);
  if (after.answer.code == Errc::unsupported) {
    return checks.does_not_apply("it refuses the moved scene: " + after.answer.message);
  }
  const std::string how = difference_moved(scene, before, after, move);
  checks.expect(how.empty(), how);
}

}  // namespace

void check_symmetries(const Subject& subject, Checks& checks) {
  const Scene scene = drawn_scene(subject, 0.15, 0.4, 0);
  const Asked before = ask(subject, scene, inner_texels(scene.templ));
  if (!before.answer.is_usable()) {
    checks.begin("a scene that is moved");
    return checks.fail("reports " + to_text(before.answer) + " before it is moved");
  }
  check_move(subject, scene, before, permute_matches(scene), checks);
  check_twice(subject, scene, before, checks);
  for (const Move& move : {shift_image(), scale_image(), roll_image(scene), mirror_image(scene),
                           scale_world(), renumber_vertices(scene)}) {
    check_move(subject, scene, before, move, checks);
  }
}

}  // namespace weft::testing
