// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::lab {

struct ReportOptions {
  std::string page;              ///< file of the page; empty: report.html in the folder
  std::string assets;            ///< folder of report.css and, where npm built it, report.js
  std::string unwarping_sink{};  ///< id of the sink whose images are shown beside the flat texture
};

struct ReportFiles {
  std::string page;
  std::vector<std::string> tables;  ///< CSV files and the Markdown file
  bool figures = false;             ///< the page has figures and the 3D view, not tables only
};

/// Parts of a page from the program's folder.
struct PageAssets {
  std::string style;
  std::string script;    ///< empty where npm has not built it: then the page has tables only
  std::string licences;  ///< licences of the code in the script

  bool scripted() const { return !script.empty(); }
};

/// Fails where there is no report.css.
Result<PageAssets> read_assets(const std::string& folder);

struct Section {
  std::string id;
  std::string title;
  std::string content;  ///< HTML; a section without it is omitted
};

struct Page {
  std::string title;
  std::string subtitle;
  std::string folder;             ///< that it was written from
  std::vector<Section> sections;  ///< [.] in the order of the page
  std::string data;               ///< JSON for the script
};

/// The whole page, which needs nothing beside it.
std::string page_html(const Page& page, const PageAssets& assets);

/// A place for the 3D view, which the script fills; `about` is HTML. Without truth it has no
/// controls of errors.
std::string viewer_html(const std::string& about, bool has_truth);

/// JSON that may stand inside a script element.
std::string script_safe(const std::string& json);

/// A text in full, as it is in a file; nothing where there is no such file.
std::string text_of_file(const std::string& file);

/// The table of what was run, by name, value and, in the end, the command.
std::string facts_html(const std::vector<std::pair<std::string, std::string>>& facts,
                       const std::string& command);

}  // namespace weft::lab
