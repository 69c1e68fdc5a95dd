// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/results/results.hpp"

namespace weft::cli {

/// Prints the first cells that failed, with the reason.
void print_failures(const lab::Results& results);

/// Prints the first cells that are done although some of their frames had an error.
void print_errors(const lab::Results& results);

}  // namespace weft::cli
