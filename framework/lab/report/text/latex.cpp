// SPDX-License-Identifier: Apache-2.0
#include "lab/report/text/latex.hpp"

#include <sstream>
#include <utility>

namespace weft::lab {

std::string latex_comment(const std::string& text) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) result += "% " + line + "\n";
  return result;
}

std::string latex_escaped(const std::string& text) {
  static const std::pair<const char*, const char*> kSpecial[] = {{"\\", "\\textbackslash{}"},
                                                                 {"~", "\\textasciitilde{}"},
                                                                 {"^", "\\textasciicircum{}"},
                                                                 {"&", "\\&"},
                                                                 {"%", "\\%"},
                                                                 {"$", "\\$"},
                                                                 {"#", "\\#"},
                                                                 {"_", "\\_"},
                                                                 {"{", "\\{"},
                                                                 {"}", "\\}"},
                                                                 {"−", "$-$"},
                                                                 {"–", "--"},
                                                                 {"·", "$\\cdot$"},
                                                                 {"×", "$\\times$"},
                                                                 {"…", "\\dots{}"}};
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const std::string_view rest = std::string_view(text).substr(i);
    std::size_t taken = 0;
    for (const auto& [from, to] : kSpecial) {
      if (!rest.starts_with(from)) continue;
      result += to;
      taken = std::string_view(from).size();
      break;
    }
    if (taken == 0) result += text[i];
    i += taken == 0 ? 1 : taken;
  }
  return result;
}

std::string to_latex(const TextTable& whole, const std::string& origin) {
  const TextTable table = folded(whole);
  std::string columns, heads, text = latex_comment(origin);
  text += "% " + table.title + ". " + table.note + "\n";
  for (const TextColumn& column : table.columns) {
    columns += column.numeric ? 'r' : 'l';
    heads += (heads.empty() ? "" : " & ") + latex_escaped(column.name);
  }
  text += "\\begin{tabular}{" + columns + "}\n\\toprule\n" + heads + " \\\\\n\\midrule\n";
  for (const TextRow& row : table.rows) {
    std::string cells;
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      cells += (i > 0 ? " & " : "") + latex_escaped(row.cells[i].shown);
    }
    text += cells + " \\\\\n";
  }
  return text + "\\bottomrule\n\\end{tabular}\n";
}

}  // namespace weft::lab
