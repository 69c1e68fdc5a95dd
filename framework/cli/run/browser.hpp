// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "cli/output/scratch_folder.hpp"

namespace weft::cli {

/// Opens a page with the desktop's browser, if there is one. An address with a token is a secret,
/// and all users can read the arguments of a program. The browser therefore receives a private file
/// that redirects to the page. This object removes the file when it is destroyed.
class Browser {
 public:
  void open(const std::string& page, const std::string& token);

 private:
  /// Its address; empty where it cannot be written.
  std::string write_private(const std::string& page);

  std::optional<ScratchFolder> folder_;
};

}  // namespace weft::cli
