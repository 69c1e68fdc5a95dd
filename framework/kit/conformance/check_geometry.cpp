// SPDX-License-Identifier: Apache-2.0
// The laws of geometry.
#include "kit/testing/geometry/check_geometry.hpp"

#include "kit/conformance/role_checks.hpp"

namespace weft::conformance {

void check_geometry(const Setting& setting, Notebook& notebook) {
  RoleChecks("geometry", notebook).make([&](testing::Checks& checks) {
    const testing::ScratchFolder folder;
    const auto subject = setting.candidate.find(folder.path().string());
    if (subject) testing::check_geometry(*subject, checks);
  });
}

}  // namespace weft::conformance
