// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "kit/testing/contract_scene.hpp"
#include "kit/testing/contract_subject.hpp"

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
  std::vector<Input> inputs;  ///< [.] inputs of the call

  bool gives(std::string_view slot) const {
    return std::any_of(inputs.begin(), inputs.end(),
                       [&](const Input& input) { return input.slot == slot; });
  }
};

/// What the scene holds of the inputs that the component takes, but for those `left_out`.
std::vector<Input> inputs_of(const Subject& subject, const Scene& scene,
                             const std::set<std::string>& left_out = {});

/// Usual inputs, those without what is optional, and degenerate ones, as far as the component takes
/// what they are about.
std::vector<Case> cases_of(const Subject& subject);

}  // namespace weft::testing
