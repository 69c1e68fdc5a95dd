// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/metrics/run_metrics.hpp"
#include "lab/metrics/runs/run_reader.hpp"

namespace weft::lab {

/// A patch of the flat print, where it should be and where the unwarped image shows it.
struct PrintPatch {
  double u_px = 0.0, v_px = 0.0;              ///< centre, px of the texture
  double du_mm = kUnknown, dv_mm = kUnknown;  ///< to where it was found; NaN where it was not
};

/// A frame that was compared with the flat print.
struct PrintFrame {
  std::string rank;         ///< "Worst", "Median" or "Best" by the patches within 1 mm; or "Only"
  std::uint64_t frame = 0;  ///< [] index of the frame
  std::vector<PrintPatch> patches;   ///< [.] compared patches
  std::string media_type, unwarped;  ///< media type and content of the unwarped image; empty
                                     ///< without one
};

/// The flat print and some of the frames that were compared with it.
struct FlatPrint {
  std::int64_t width_px = 0, height_px = 0;  ///< [] of the texture
  double mm_per_px_u = kUnknown,
         mm_per_px_v = kUnknown;   ///< [] mm per px of the texture along u and v
  std::string png;                 ///< the texture, reduced in size
  std::vector<PrintFrame> frames;  ///< the worst first; empty for a run that was not compared
};

/// The comparison with the flat texture in a run folder. `unwarping_sink` is the id of the sink
/// that writes unwarped images; its folder is the one that the run's pipeline names. Fails if a
/// frame cannot be read.
Result<FlatPrint> read_flat_print(const RunReader& run, const RunMetrics& metrics,
                                  const std::string& unwarping_sink);

/// The frames on the page: arrows over the flat print and over the unwarped image. Empty without
/// frames.
std::string flat_print_html(const FlatPrint& print, const RunMetrics& metrics);

}  // namespace weft::lab
