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

/// The legal answers of a component to an input.
enum class Expect {
  answer,   ///< ok or degenerate
  any,      ///< also no_result or an error with a reason; but not ok with empty outputs
  warning,  ///< as any, but never ok: the input contains no information
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

/// The scene's values for the inputs that the component takes, except those in `left_out`.
std::vector<Input> inputs_of(const Subject& subject, const Scene& scene,
                             const std::set<std::string>& left_out = {});

/// Usual inputs, those without what is optional, and degenerate ones, as far as the component takes
/// what they are about.
std::vector<Case> cases_of(const Subject& subject);

}  // namespace weft::testing
