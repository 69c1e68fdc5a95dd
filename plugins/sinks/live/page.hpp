// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace weft::live {

/// A file of the page, which is part of this library.
struct PageFile {
  std::string_view type;  ///< as in HTTP's Content-Type
  std::string_view content;
  bool is_public;  ///< code without a secret: scripts and styles, which a page loads by itself
};

/// The file of the path `/`, `/live.js` or `/live.css`; null for others.
const PageFile* page_file(std::string_view path);

}  // namespace weft::live
