// SPDX-License-Identifier: Apache-2.0
#include "lab/report/text/table_files.hpp"

#include <filesystem>
#include <utility>
#include <weft/core/whole_file.hpp>

namespace weft::lab {

Result<std::vector<std::string>> write_table_files(const std::string& folder, std::string head,
                                                   std::vector<TextTable> tables) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  std::vector<std::string> files;
  for (TextTable& table : tables) {
    files.push_back(folder + "/" + table.id + ".csv");
    if (auto written = write_whole(to_csv(table), files.back()); !written) return written.error();
    head += to_markdown(std::move(table));
  }
  files.push_back(folder + "/tables.md");
  if (auto written = write_whole(head, files.back()); !written) return written.error();
  return files;
}

}  // namespace weft::lab
