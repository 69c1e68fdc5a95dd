// SPDX-License-Identifier: Apache-2.0
#include "kit/testing/geometry/check_geometry.hpp"

namespace weft::testing {

void check_geometry(const Subject& subject, Checks& checks) {
  const RoleRules& rules = subject.rules();
  const bool reads_geometry = rules.part == PipelinePart::stage && !rules.sees_texture;
  if (!reads_geometry) {
    checks.begin("geometry");
    checks.does_not_apply("its answer does not follow from places of matches or vertices");
    return;
  }
  check_symmetries(subject, checks);
  check_exactness(subject, checks);
  if (rules.samples) check_identity_warp(subject, checks);
}

}  // namespace weft::testing
