// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/params.hpp>

namespace weft {

/// Whose constants a component begins with.
enum class Preset { author, weft };

/// Declares `preset`, which comes before all other parameters.
inline Preset declare_preset(Params& p, Preset preset = Preset::author) {
  p.choice("preset", preset, {{"author", Preset::author}, {"weft", Preset::weft}},
           "set of constants; author: those of the authors' program; weft: those chosen for Weft; "
           "other parameters override them");
  return preset;
}

}  // namespace weft
