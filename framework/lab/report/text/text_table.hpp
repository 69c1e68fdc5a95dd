// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace weft::lab {

/// A figure as people read it and as programs do; text is the same for both.
struct TextCell {
  std::string shown;
  std::string exact;
  std::string tip{};      ///< where the figure comes from, on a page
  std::string link{};     ///< an anchor of the page
  std::string of{};       ///< where the figure is a share: the whole, exactly
  const char* tint = "";  ///< on a page: "better" or "worse"
};

TextCell text_cell(const std::string& text);
TextCell count_cell(std::int64_t count);
/// Rounded to `decimals`; nine digits for programs. NaN is shown as a dash and exactly as nothing.
TextCell number_cell(double value, int decimals);
/// The same with three digits, however small the number is.
TextCell figure_cell(double value);

struct TextColumn {
  std::string name;     ///< as people read it, with its unit
  std::string field{};  ///< as programs do
  bool numeric = false;
  std::string of{};       ///< for programs: the name of the total to which a share refers
  bool foldable = false;  ///< shown once for all rows, in readable tables, if all have the same
                          ///< value
};

struct TextRow {
  std::vector<TextCell> cells;    ///< [columns] cells of the row
  std::ptrdiff_t treatment = -1;  ///< on a page, which combination the row lets the figures draw
  bool failed = false;
};

/// A table that becomes a file or a part of a page.
struct TextTable {
  std::string id;  ///< name of its file and its anchor
  std::string title;
  std::string note;                 ///< explanation of the figures
  std::vector<TextColumn> columns;  ///< [columns] headings
  std::vector<TextRow> rows;        ///< [rows] rows without the heading
  bool sortable = true;             ///< on a page, by each of its columns
};

/// Removes the foldable columns in which all rows, of at least two, have the same value. `note`
/// then begins with the known ones: "In every row: cells failed 0 of 20; n 8."
TextTable folded(TextTable table);

/// Every column, however alike its cells are. Shares have a second column, with the whole.
std::string to_csv(const TextTable& table);
/// Folded.
std::string to_markdown(TextTable table);
std::string to_html(TextTable table);

/// Text in HTML, in an attribute as well.
std::string html_escaped(const std::string& text);
/// Text that is no markup in Markdown.
std::string markdown_escaped(const std::string& text);

}  // namespace weft::lab
