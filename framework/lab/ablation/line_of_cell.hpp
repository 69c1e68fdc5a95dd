// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/ablation/cell_group.hpp"
#include "lab/results/damage.hpp"

namespace weft::lab {

/// The line of a cell in a results folder, with its check, without its line break. `files` are
/// those of its folder.
std::string line_of_cell(const Cell& cell, const CellResult& result, bool timed,
                         const Measurement& measurement, const std::vector<CellFile>& files);

}  // namespace weft::lab
