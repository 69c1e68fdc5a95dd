// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/detector.hpp>
#include <weft/sdk/filter.hpp>
#include <weft/sdk/matcher.hpp>
#include <weft/sdk/pass.hpp>
#include <weft/sdk/sink.hpp>
#include <weft/sdk/solver.hpp>
#include <weft/sdk/source.hpp>
#include <weft/sdk/template_builder.hpp>
#include <weft/sdk/warp_model.hpp>

namespace weft {

/// All roles, in the order in which data flow through them.
inline std::vector<Role> all_roles() {
  return {Source::role(),  TemplateBuilder::role(), Detector::role(),
          Matcher::role(), Filter::role(),          WarpModel::role(),
          Pass::role(),    Solver::role(),          Sink::role()};
}

}  // namespace weft
