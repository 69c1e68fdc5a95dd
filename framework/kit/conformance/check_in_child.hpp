// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "kit/conformance/notebook.hpp"

namespace weft::conformance {

/// Makes checks in a process of their own, a copy of this one, which must have one thread. What
/// ends it, a crash, an exit or a check that takes longer than `longest`, is a failure of the check
/// that was being made, or of `first` where none was; the checks behind it are not made then. What
/// it prints is seen by nobody, but for the last line before it was ended.
std::vector<Finding> check_in_child(const std::string& first, const Choice& choice,
                                    std::chrono::seconds longest,
                                    const std::function<void(Notebook&)>& make);

}  // namespace weft::conformance
