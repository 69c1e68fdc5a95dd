// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace weft {

/// All records and roles as a Markdown page, made from the declarations that the code itself uses.
std::string catalogue_page();

}  // namespace weft
