// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "testing/contract_scene.hpp"
#include "testing/contract_subject.hpp"

namespace weft::testing {

/// What a component may answer to an input.
enum class Expect {
  answer,   ///< ok or degenerate
  any,      ///< also no_result or an error that says why; but not ok with nothing
  warning,  ///< as any, but never ok: there is nothing to go by
};

/// An input of a stage's method.
struct Case {
  std::string name;  ///< "with 0 matches"
  Expect expect;
  Scene scene;
  std::vector<Input> inputs;

  bool gives(std::string_view slot) const {
    return std::any_of(inputs.begin(), inputs.end(),
                       [&](const Input& input) { return input.slot == slot; });
  }
};

/// Usual inputs, those without what is optional, and degenerate ones, as far as the component takes
/// what they are about.
std::vector<Case> cases_of(const Subject& subject);

}  // namespace weft::testing
