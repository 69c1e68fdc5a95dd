// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/report/figures.hpp"
#include "lab/report/text/page.hpp"

namespace weft::lab {

/// Content of the page of an ablation; `scripted`: with places for figures.
Page page_of(const Results& results, const ReportTables& tables, const Figures& figures,
             bool scripted);

}  // namespace weft::lab
