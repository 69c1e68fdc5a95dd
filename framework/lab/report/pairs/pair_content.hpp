// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/report/panel_figures.hpp"
#include "lab/report/text/text_table.hpp"

namespace weft::lab {

/// A comparison of two folders.
struct PairContent {
  std::string version;                 ///< version of weft that wrote A
  std::vector<std::string> sentences;  ///< results, the most important first
  std::vector<std::string> refusals;   ///< parts that cannot be compared, with the reason
  std::vector<PanelFigure> figures;
  std::vector<TextTable> tables;
};

Result<PairContent> compare_runs(const std::string& a, const std::string& b);
Result<PairContent> compare_ablations(const std::string& a, const std::string& b);

}  // namespace weft::lab
