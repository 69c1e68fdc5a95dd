// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/report/drawing/drawing.hpp"

namespace weft::lab {

/// "0b6bb3": the colour in the light theme, as framework/web/src/tokens.css has it; "ink" for an
/// unknown name.
std::string rgb_of(ColourName name);

/// The colour of the n-th series, from 0; after eight they begin anew.
ColourName series_colour(std::size_t n);

}  // namespace weft::lab
