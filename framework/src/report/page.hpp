// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/figures.hpp"
#include "report/text/page.hpp"

namespace weft::evaluation {

/// What the page of an ablation has; `scripted`: with places for figures.
Page page_of(const Results& results, const ReportTables& tables, const Figures& figures,
             bool scripted);

}  // namespace weft::evaluation
