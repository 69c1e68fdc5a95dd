// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::lab {

/// Whether `path` is free for the results of a plan of this name, or holds results of it already.
/// Where manifest.json or plan.json is missing, empty or cut off beside results, as a power cut or
/// a full disk leaves them, the folder is usable all the same: returns a sentence for each of these
/// files, which ResultsFolder::describe() writes anew.
Result<std::vector<std::string>> check_results_folder(const std::string& path,
                                                      const std::string& plan);

}  // namespace weft::lab
