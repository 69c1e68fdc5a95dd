// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <weft/core/rng.hpp>

#include "annealing.hpp"
#include "confidence.hpp"

namespace weft::aem {

/// The vertices of a template where the last shape had them.
struct Track {
  Points2 flat_px;   ///< [V,2] of the texture
  Points2 image_px;  ///< [V,2]
};

struct SearchOptions {
  AnnealingOptions annealing;
  int most_draws = 10000;
  double sure = 0.75;  ///< confidence from which the track is believed
};

/// The set of matches that is taken for the object, and the evidence against it.
struct Found {
  Solution solution;
  double scale = 1.0;       ///< [] image px per template px, of the start
  double confidence = 0.0;  ///< [] 0 to 1
  double rival = 0.0;       ///< [] log-likelihood of the best other set, in parts of this one's
  bool tracked = false;
  int draws = 0;
};

/// The coherent set of greatest likelihood. A set that starts from the track is preferred while a
/// confident one exists. Nothing where no seed resembles a surface.
std::optional<Found> find_object(const Matches& matches, const std::optional<Track>& track,
                                 const SearchOptions& options, Rng& rng);

}  // namespace weft::aem
