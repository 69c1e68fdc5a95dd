// SPDX-License-Identifier: Apache-2.0
#include "pipeline/overview/drawing.hpp"

#include <algorithm>
#include <cstdio>
#include <weft/core/index.hpp>

#include "pipeline/overview/chart_lines.hpp"

namespace weft {
namespace {

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(width > text.size() ? width - text.size() : 0, ' ');
}

/// The line with its columns of box-drawing characters, and the name of an output behind them.
std::string columns_text(const WiringChart& chart, const ChartLine& line) {
  std::string text = line.reads.empty() ? "──" : "◀─";
  const std::size_t reach = line.reach();
  for (std::size_t column = 0; column < chart.values.size(); ++column) {
    const bool is_left = column < reach;
    const WiringChart::Input* read = line.read_of(column);
    if (line.output == column || (read != nullptr && read->required)) {
      text += "●";
    } else if (read != nullptr) {
      text += "○";
    } else if (line.is_open[column]) {
      text += is_left ? "┼" : "│";
    } else if (is_left) {
      text += "─";
    } else {
      text += ' ';
    }
    if (line.output == column) return text + ' ' + chart.values[column].type;
    text += is_left ? "─" : " ";
  }
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

/// Connections between two rows, which graphs of nodes and edges show as one.
struct Edge {
  std::size_t from, to;
  std::string types;      ///< "image, camera"
  bool required = false;  ///< any of them
};

std::vector<Edge> edges_of(const WiringChart& chart) {
  std::vector<Edge> edges;
  for (std::size_t to = 0; to < chart.rows.size(); ++to) {
    for (const WiringChart::Input& input : chart.rows[to].inputs) {
      const WiringChart::Value& value = chart.values[input.value];
      const auto same = [&](const Edge& edge) { return edge.from == value.maker && edge.to == to; };
      auto edge = std::find_if(edges.begin(), edges.end(), same);
      if (edge == edges.end()) edge = edges.insert(edge, {value.maker, to, "", false});
      edge->types += (edge->types.empty() ? "" : ", ") + value.type;
      edge->required = edge->required || input.required;
    }
  }
  return edges;
}

/// The name, id and time of a row, each in a line.
std::string label_of(const WiringChart::Row& row, const std::string& line_break) {
  std::string label = row.name;
  if (!row.id.empty()) label += line_break + row.id;
  if (row.ms) label += line_break + milliseconds(*row.ms);
  return label;
}

std::string in_quotes(const std::string& text) { return '"' + text + '"'; }

}  // namespace

std::string chart_text(const WiringChart& chart) {
  std::size_t name_width = 0, id_width = 0;
  for (const WiringChart::Row& row : chart.rows) {
    name_width = std::max(name_width, row.name.size() + 2);
    id_width = std::max(id_width, row.id.size() + 2);
  }
  const bool is_timed = std::any_of(chart.rows.begin(), chart.rows.end(),
                                    [](const WiringChart::Row& row) { return row.ms.has_value(); });
  std::string text;
  for (const ChartLine& line : lines_of(chart)) {
    const WiringChart::Row row = line.is_first ? chart.rows[line.row] : WiringChart::Row{};
    const std::string time = row.ms ? milliseconds(*row.ms) : "";
    text += padded(row.name, name_width) + padded(row.id, id_width);
    if (is_timed) text += padded("", 9 - std::min<std::size_t>(time.size(), 9)) + time + "  ";
    text += columns_text(chart, line) + "\n";
  }
  return text;
}

std::string chart_mermaid(const WiringChart& chart) {
  std::string text = "flowchart LR\n";
  for (std::size_t i = 0; i < chart.rows.size(); ++i) {
    text += "  n" + std::to_string(i) + "[" + in_quotes(label_of(chart.rows[i], "<br/>")) + "]\n";
  }
  for (const Edge& edge : edges_of(chart)) {
    text += "  n" + std::to_string(edge.from) + (edge.required ? " -->|" : " -.->|") +
            in_quotes(edge.types) + "| n" + std::to_string(edge.to) + "\n";
  }
  return text;
}

std::string chart_dot(const WiringChart& chart) {
  std::string text =
      "digraph pipeline {\n  rankdir=LR;\n"
      "  node [shape=box, style=rounded, fontname=\"sans-serif\"];\n"
      "  edge [fontname=\"sans-serif\", fontsize=10];\n";
  for (std::size_t i = 0; i < chart.rows.size(); ++i) {
    text +=
        "  n" + std::to_string(i) + " [label=" + in_quotes(label_of(chart.rows[i], "\\n")) + "];\n";
  }
  for (const Edge& edge : edges_of(chart)) {
    text += "  n" + std::to_string(edge.from) + " -> n" + std::to_string(edge.to) +
            " [label=" + in_quotes(edge.types) + (edge.required ? "" : ", style=dashed") + "];\n";
  }
  return text + "}\n";
}

}  // namespace weft
