// SPDX-License-Identifier: Apache-2.0
#include "lab/report/text/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <weft/core/csv_field.hpp>

namespace weft::lab {
namespace {

constexpr const char* kNothing = "–";  ///< shown for an unknown number

/// A long name may break behind its dots.
std::string breakable(const std::string& name) {
  std::string result;
  for (const char c : html_escaped(name)) {
    result += c;
    if (c == '.') result += "<wbr>";
  }
  return result;
}

std::string heading_html(const TextColumn& column) {
  return fmt::format("<th scope=\"col\"{}>{}</th>", column.numeric ? " class=\"number\"" : "",
                     breakable(column.name));
}

std::string cell_html(const TextCell& cell, bool numeric, const std::string& before) {
  std::string attributes = numeric ? " class=\"number\"" : "";
  if (*cell.tint != '\0') attributes += fmt::format(" class=\"{}\"", cell.tint);
  if (numeric) attributes += fmt::format(" data-value=\"{}\"", html_escaped(cell.exact));
  if (!cell.tip.empty()) attributes += fmt::format(" title=\"{}\"", html_escaped(cell.tip));
  std::string text = html_escaped(cell.shown);
  if (!cell.link.empty()) {
    text = fmt::format("<a href=\"#{}\">{}</a>", html_escaped(cell.link), text);
  }
  return fmt::format("<td{}>{}{}</td>", attributes, before, text);
}

std::string row_html(const TextTable& table, const TextRow& row) {
  std::string text = row.failed ? "<tr class=\"failed\">" : "<tr>";
  for (std::size_t i = 0; i < row.cells.size(); ++i) {
    std::string before;
    if (i == 0 && row.treatment >= 0) {
      before = fmt::format(
          "<button type=\"button\" class=\"swatch\" data-treatment=\"{}\" aria-label=\"Draw it in "
          "the figures\"></button> ",
          row.treatment);
    }
    text += cell_html(row.cells[i], table.columns[i].numeric, before);
  }
  return text + "</tr>\n";
}

}  // namespace

TextCell text_cell(const std::string& text) { return {text, text}; }

TextCell count_cell(std::int64_t count) { return text_cell(std::to_string(count)); }

TextCell number_cell(double value, int decimals) {
  if (!std::isfinite(value)) return {kNothing, ""};
  return {fmt::format("{:.{}f}", value, decimals), fmt::format("{:.9g}", value)};
}

TextCell figure_cell(double value) {
  TextCell cell = number_cell(value, 0);
  if (std::isfinite(value)) cell.shown = fmt::format("{:.3g}", value + 0.0);
  return cell;
}

TextTable folded(TextTable table) {
  if (table.rows.size() < 2) return table;
  std::string common;
  for (std::size_t c = table.columns.size(); c-- > 1;) {
    const std::string& first = table.rows.front().cells[c].shown;
    const bool same = std::all_of(table.rows.begin(), table.rows.end(),
                                  [&](const TextRow& row) { return row.cells[c].shown == first; });
    if (!table.columns[c].foldable || !same) continue;
    if (!first.empty() && first != kNothing) {
      common = table.columns[c].name + " " + first + (common.empty() ? "" : "; ") + common;
    }
    const auto at = static_cast<std::ptrdiff_t>(c);
    table.columns.erase(table.columns.begin() + at);
    for (TextRow& row : table.rows) row.cells.erase(row.cells.begin() + at);
  }
  if (!common.empty()) {
    table.note = "In every row: " + common + "." + (table.note.empty() ? "" : " ") + table.note;
  }
  return table;
}

std::string to_csv(const TextTable& table) {
  std::string text;
  for (const TextColumn& column : table.columns) {
    text += (text.empty() ? "" : ",") + csv_field(column.field);
    if (!column.of.empty()) text += "," + csv_field(column.of);
  }
  text += "\n";
  for (const TextRow& row : table.rows) {
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      text += (i > 0 ? "," : "") + csv_field(row.cells[i].exact);
      if (!table.columns[i].of.empty()) text += "," + csv_field(row.cells[i].of);
    }
    text += "\n";
  }
  return text;
}

std::string to_markdown(TextTable whole) {
  const TextTable table = folded(std::move(whole));
  std::string text = "## " + table.title + "\n\n";
  if (!table.note.empty()) text += markdown_escaped(table.note) + "\n\n";
  std::string rule;
  for (const TextColumn& column : table.columns) {
    text += "| " + markdown_escaped(column.name) + " ";
    rule += column.numeric ? "|---:" : "|---";
  }
  text += "|\n" + rule + "|\n";
  for (const TextRow& row : table.rows) {
    for (const TextCell& cell : row.cells) text += "| " + markdown_escaped(cell.shown) + " ";
    text += "|\n";
  }
  return text + "\n";
}

std::string to_html(TextTable whole) {
  constexpr std::size_t kMostRows = 1000;  // a browser takes seconds for more
  const std::size_t all = whole.rows.size();
  if (all > kMostRows) {
    whole.rows.resize(kMostRows);
    whole.note =
        fmt::format("The first {} of {} rows: report/{}.csv has all. ", kMostRows, all, whole.id) +
        whole.note;
  }
  const TextTable table = folded(std::move(whole));
  std::string text = fmt::format(
      "<div class=\"scroll\" tabindex=\"0\"><table class=\"{}\" id=\"table-{}\"><thead><tr>",
      table.sortable ? "sortable" : "matrix", table.id);
  for (const TextColumn& column : table.columns) text += heading_html(column);
  text += "</tr></thead>\n<tbody>\n";
  for (const TextRow& row : table.rows) text += row_html(table, row);
  text += "</tbody></table></div>\n";
  if (table.note.empty()) return text;
  return text + "<p class=\"small muted\">" + html_escaped(table.note) + "</p>\n";
}

std::string markdown_escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '|' || c == '\\' || c == '*' || c == '_' || c == '`' || c == '<') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string html_escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

}  // namespace weft::lab
