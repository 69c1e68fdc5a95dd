// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <iterator>
#include <weft/core/index.hpp>

#include "kit/testing/geometry/bounds.hpp"
#include "kit/testing/geometry/check_geometry.hpp"

namespace weft::testing {
namespace {

constexpr double kLevels_px[] = {0.0, 1.0, 4.0};
constexpr int kRounds = 3;

void check_exact(const Subject& subject, Checks& checks) {
  checks.begin("exact matches");
  const Scene scene = drawn_scene(subject, 0.0, 0.0, 0);
  const Points2 texels_px = inner_texels(scene.templ);
  const Asked asked = ask(subject, scene, texels_px);
  if (!asked.answer.is_usable()) return checks.fail("reports " + to_text(asked.answer));
  for (const Deviation& deviation : deviations_of(scene, asked, texels_px)) {
    checks.expect(deviation.value <= deviation.bound, deviation.what);
  }
}

/// Mean error of each round; infinite where it gives no answer, which is the worst.
Eigen::ArrayXd errors_at(const Subject& subject, double noise_px) {
  Eigen::ArrayXd errors(kRounds);
  for (int round = 0; round < kRounds; ++round) {
    const Scene scene = drawn_scene(subject, 0.15, noise_px, round);
    const Points2 texels_px = inner_texels(scene.templ);
    const Asked asked = ask(subject, scene, texels_px);
    const auto deviations = deviations_of(scene, asked, texels_px);
    const bool answered = asked.answer.is_usable() && !deviations.empty();
    errors(round) = answered ? deviations.front().value : INFINITY;
  }
  return errors;
}

/// The tolerance for a random decrease of the mean: twice its standard error, and a twentieth for
/// errors that do not come from noise.
double slack(const Eigen::ArrayXd& growth, double error) {
  const double spread = (growth - growth.mean()).square().sum() / (kRounds - 1);
  return 2.0 * std::sqrt(spread / kRounds) + 0.05 * error;
}

void check_noise(const Subject& subject, Checks& checks) {
  checks.begin("error grows with noise");
  const RoleRules& rules = subject.rules();
  if (!rules.marks && !rules.solves && !rules.samples) {
    return checks.does_not_apply("it hands on the noise of what it is given");
  }
  Eigen::ArrayXd before = errors_at(subject, kLevels_px[0]);
  for (std::size_t level = 1; level < std::size(kLevels_px); ++level) {
    const Eigen::ArrayXd errors = errors_at(subject, kLevels_px[level]);
    const Eigen::ArrayXd growth = errors - before;
    const bool falls = !errors.isInf().any() && !(growth.mean() >= -slack(growth, before.mean()));
    if (falls) {
      checks.fail("with " + std::to_string(std::lround(kLevels_px[level])) + " px it falls from " +
                  std::to_string(before.mean()) + " to " + std::to_string(errors.mean()));
    }
    before = errors;
  }
}

}  // namespace

void check_exactness(const Subject& subject, Checks& checks) {
  check_exact(subject, checks);
  check_noise(subject, checks);
}

}  // namespace weft::testing
