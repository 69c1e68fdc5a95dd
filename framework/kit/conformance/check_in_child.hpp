// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "kit/conformance/notebook.hpp"

namespace weft::conformance {

/// Makes checks in a separate process, a copy of this one, which must have one thread. A crash, an
/// exit or a check that takes longer than `longest` is a failure of the current check, or of
/// `first` before any check began. The checks after it are not made. The output of the process is
/// discarded, except the last line before it was ended.
std::vector<Finding> check_in_child(const std::string& first, const Choice& choice,
                                    std::chrono::seconds longest,
                                    const std::function<void(Notebook&)>& make);

}  // namespace weft::conformance
