// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/survey/first_frame.hpp"

namespace weft {

/// A template whose texture coordinates agree with the matches of frames that show it at rest.
struct RefittedTemplate {
  Template templ;
  std::int64_t frames = 0;  ///< [] that it was fitted to
  ResidualField before, after;
};

/// Corrects the texture coordinates in a few rounds, each with its own poses. Frames in which the
/// object at rest is more than 2 % of its size off its matches are not used. no_result where no
/// frame is left, or too few matches.
Result<RefittedTemplate> refit(const FirstFrame& first);

/// The same from matches of frames.
Result<RefittedTemplate> refit(const Template& templ, const Camera& camera,
                               const std::vector<Correspondences>& frames);

}  // namespace weft
