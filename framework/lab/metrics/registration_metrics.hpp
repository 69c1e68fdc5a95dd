// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/data/visibility.hpp>

#include "lab/metrics/field.hpp"
#include "lab/statistics/unknown.hpp"

namespace weft::lab {

/// One frame against its flat reference. A patch that was not found is within no distance.
struct FrameRegistration {
  std::int64_t patches = 0, found = 0;          ///< [] numbers of patches
  std::int64_t within_1mm = 0, within_2mm = 0;  ///< [] patches found at most so far away
  double within_1mm_percent = kUnknown;         ///< [] of all patches
  double within_2mm_percent = kUnknown;         ///< [] of all patches
  double found_percent = kUnknown;              ///< [] of all patches
  double median_mm = kUnknown;                  ///< [] mm, over the patches that were found
  double p90_mm = kUnknown;                     ///< [] mm, likewise
  std::vector<double> distances_mm;             ///< [found] mm, of the patches that were found

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"registration_patches", "words or other patches of the flat reference"}, self.patches);
    visit({"registration_within_1mm_percent", "of them, found within 1 mm of their place", kHigher,
           "within 1 mm %", 1},
          self.within_1mm_percent);
    visit({"registration_within_2mm_percent", "of them, found within 2 mm", kHigher},
          self.within_2mm_percent);
    visit({"registration_found_percent", "of them, found", kHigher}, self.found_percent);
    visit({"registration_median_mm", "median distance of those found", kLower, "displaced mm"},
          self.median_mm);
    visit({"registration_p90_mm", "90th percentile of those found", kLower}, self.p90_mm);
  }
};

/// The same over a run. All patches count the same, regardless of their frames.
struct RegistrationMetrics {
  std::int64_t frames = 0;               ///< [] that were measured
  std::int64_t frames_unmeasured = 0;    ///< [] the others of a run with any that were measured
  std::int64_t patches = 0;              ///< [] patches over all frames
  double within_1mm_percent = kUnknown;  ///< [] of all patches
  double within_2mm_percent = kUnknown;  ///< [] of all patches
  double found_percent = kUnknown;       ///< [] of all patches
  double median_mm = kUnknown;           ///< [] mm, over the patches that were found
  double p90_mm = kUnknown;              ///< [] mm, likewise

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"frames", "compared with the flat reference"}, self.frames);
    visit({"frames_unmeasured", "without a shape that could be compared", kLower},
          self.frames_unmeasured);
    visit({"patches", "words or other patches of the flat reference, over these frames"},
          self.patches);
    visit({"within_1mm_percent", "of the patches, found within 1 mm of their place", kHigher},
          self.within_1mm_percent);
    visit({"within_2mm_percent", "of the patches, found within 2 mm", kHigher},
          self.within_2mm_percent);
    visit({"found_percent", "of the patches, found", kHigher}, self.found_percent);
    visit({"median_mm", "median distance of the patches found", kLower}, self.median_mm);
    visit({"p90_mm", "90th percentile of the patches found", kLower}, self.p90_mm);
  }
};

FrameRegistration frame_registration(const Registration& measured);

/// `all_frames` counts those that were not measured too.
RegistrationMetrics summarise_registration(const std::vector<FrameRegistration>& frames,
                                           std::int64_t all_frames);

}  // namespace weft::lab
