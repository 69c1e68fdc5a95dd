// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/figures.hpp"

namespace weft::evaluation {

/// What a page has in it from the program's folder.
struct PageAssets {
  std::string style;
  std::string script;    ///< empty where npm has not built it: then the page has tables only
  std::string licences;  ///< of what the script contains
};

/// The whole page.
std::string page_html(const Results& results, const ReportTables& tables, const Figures& figures,
                      const PageAssets& assets);

}  // namespace weft::evaluation
