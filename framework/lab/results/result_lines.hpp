// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lab/results/cell_line.hpp"
#include "lab/results/cell_record.hpp"

/// The lines in results/ of a results folder, read the same way by all that read them.
namespace weft::lab {

using TakeLine = std::function<Result<void>(const LinePlace&, const nlohmann::json&)>;

/// Errors in lines, and how many could not be checked.
struct LineFaults {
  std::vector<Damage> damaged;  ///< [.] lines that cannot be trusted
  std::size_t unchecked = 0;    ///< [] lines without a check
};

/// Gives all lines of cells that count to `take`, by file and line. Withdrawn lines and a truncated
/// line at the end of a file are omitted. An Error of `take` with invalid_data counts as damage;
/// any other ends it. Fails if a file cannot be read or has a line of another schema.
Result<LineFaults> read_result_lines(const std::string& folder, const LineParts& parts,
                                     const TakeLine& take);

/// The error of a cell's files, compared with its line; empty if there is none. Compares their
/// sizes and, with `content`, their hashes. For lines of older programs it checks only that the
/// folder exists.
std::string fault_of_files(const std::string& folder, const std::vector<CellFile>& files,
                           bool content);

/// The file `folder`/cells/`key` as CellFile.
Result<CellFile> cell_file(const std::string& folder, const std::string& name);

}  // namespace weft::lab
