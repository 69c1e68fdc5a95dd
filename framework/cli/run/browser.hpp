// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "cli/output/scratch_folder.hpp"

namespace weft::cli {

/// Opens a page by the desktop, if there is one. An address with a token is a secret that the
/// arguments of a program would show to all users: the browser is given a private file that leads
/// to the page, which is removed with this object.
class Browser {
 public:
  void open(const std::string& page, const std::string& token);

 private:
  /// Its address; empty where it cannot be written.
  std::string write_private(const std::string& page);

  std::optional<ScratchFolder> folder_;
};

}  // namespace weft::cli
