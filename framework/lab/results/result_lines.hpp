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

/// Gives all lines of cells that count to `take`, by file and line: what was withdrawn and what is
/// cut off at the end of a file is left out. An Error of `take` with invalid_data counts as damage;
/// any other ends it. Fails where a file cannot be read or has a line of another schema.
Result<LineFaults> read_result_lines(const std::string& folder, const LineParts& parts,
                                     const TakeLine& take);

/// What is wrong with the files of a cell, as its line lists them; empty: nothing. Their sizes are
/// compared, and with `content` their hashes too. Of lines of older programs only the folder is
/// looked for.
std::string fault_of_files(const std::string& folder, const std::vector<CellFile>& files,
                           bool content);

/// What stands in `folder`/cells/`key` as CellFile.
Result<CellFile> cell_file(const std::string& folder, const std::string& name);

}  // namespace weft::lab
