// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>

#include "common/ply/ply_header.hpp"

namespace weft::ply {

/// The values of one element, those of each property; one value unless it is a list.
using PlyRow = std::vector<std::vector<double>>;

/// True if the first word of a text marks it as a PLY file.
bool is_ply(std::string_view text);

/// The number of a property; NaN where `property` is -1 or a list of another length than one.
double number_at(const PlyRow& row, int property);

/// Reads the rows of a PLY file one after another: ascii, or binary of either byte order. Errors
/// have the form "path:line: what; fix", or have the number of the element where there are no
/// lines.
class PlyReader {
 public:
  /// `text` must outlive this.
  PlyReader(std::string path, std::string_view text) : path_(std::move(path)), lines_(text) {}

  Result<void> read_header(PlyUse use);

  /// Calls take(element, i, row) -> Result<void> for row i of each element, in the file's order.
  template <class Take>
  Result<void> for_each_row(Take&& take) {
    PlyRow row;
    for (const PlyElement& element : header_.elements) {
      row.assign(element.properties.size(), {});
      for (std::int64_t i = 0; i < element.count; ++i) {
        if (auto read = read_row(element, i, row); !read) return read;
        if (Result<void> taken = take(element, i, row); !taken) return taken;
      }
    }
    return {};
  }

  /// An error in row i of an element.
  Error mistake(const PlyElement& element, std::int64_t i, const std::string& sentence) const;

  /// The line of the row that was read last, from 1; 0 in a binary file.
  std::int64_t line() const;

 private:
  Error cut_off(const PlyElement& element, std::int64_t i) const;
  Result<void> read_row(const PlyElement& element, std::int64_t i, PlyRow& row);
  Result<void> read_ascii(const PlyElement& element, std::int64_t i, PlyRow& row);
  Result<void> read_binary(const PlyElement& element, std::int64_t i, PlyRow& row);
  std::optional<double> binary_value(PlyType type);

  std::string path_;
  TextLines lines_;
  PlyHeader header_;
  std::string_view bytes_;  ///< behind the header
};

}  // namespace weft::ply
