// SPDX-License-Identifier: Apache-2.0
#include "mutants/operators.hpp"

#include <algorithm>

#include "mutants/operator_table.hpp"

namespace weft::mutants {

std::span<const Operator> operators() { return kOperators; }

const Operator* find_operator(std::string_view name) {
  const auto* found = std::find_if(std::begin(kOperators), std::end(kOperators),
                                   [&](const Operator& each) { return each.name == name; });
  return found != std::end(kOperators) ? found : nullptr;
}

}  // namespace weft::mutants
