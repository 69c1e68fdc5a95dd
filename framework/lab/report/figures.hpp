// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/report/curves.hpp"
#include "lab/report/tables/tables.hpp"
#include "lab/results/cell_folder.hpp"

namespace weft::lab {

/// A cell that the 3D view offers.
struct ShownCell {
  std::size_t cell = 0;  ///< index into Results::cells
  std::string name;      ///< "myneighbor: worst (plain_101, seed 1)"
  CellView view;
};

/// A worst frame with its image.
struct ShownFrame {
  std::size_t cell = 0;  ///< index into Results::cells
  double mean_mm = kUnknown;
  Thumbnail picture;
  CellView view = {};  ///< the frame alone; nothing where the cell keeps no shape of it
};

/// Figures of the page beside its tables.
struct Figures {
  std::vector<std::size_t> drawn;  ///< combinations that the figures draw at first
  std::size_t reference = 0;       ///< that differences are taken from: the smallest mean error
  std::vector<FrameCurve> over_frames;   ///< one a combination
  std::vector<Sweep> sweeps;             ///< [.] one per swept number
  std::vector<ShownCell> cells;          ///< [.] cells in the viewer
  std::vector<ShownFrame> worst_frames;  ///< [.] frames with large errors
};

/// Reads what the figures need; fails where the shapes of a cell are damaged.
Result<Figures> make_figures(const Results& results, const ReportTables& tables);

/// The figures' data as JSON that may stand inside a script element; arrays are base64 of
/// little-endian f32 or u32.
std::string to_json(const Results& results, const ReportTables& tables, const Figures& figures);

}  // namespace weft::lab
