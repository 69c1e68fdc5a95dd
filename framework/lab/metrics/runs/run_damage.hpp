// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

namespace weft::lab {

inline Error damaged_run(const std::string& file, const std::string& message) {
  return {Errc::invalid_data, message + "; the run folder is damaged: run the pipeline again",
          file};
}

}  // namespace weft::lab
