// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace weft::lab {

/// A file in the folder of a cell.
struct CellFile {
  std::string name;
  std::uint64_t bytes = 0;  ///< [bytes] size of the file
  std::string hash;         ///< XXH128, 32 hexadecimal digits
};

/// A result that cannot be trusted: a damaged line, or a file that its line lists in the cell's
/// folder.
struct Damage {
  std::string where;  ///< "FILE:LINE", or the cell's folder
  std::string what;   ///< is wrong
  std::string key;    ///< key of the cell; empty if unknown
  std::string file;   ///< file of the line, without folders
  int line = 0;       ///< [] number of the line; 0: none
};

}  // namespace weft::lab
