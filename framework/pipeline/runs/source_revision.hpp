// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::host {

/// The commit that the host was built from, "+changes" behind it where files differed; empty where
/// it was not built from a repository.
const char* source_revision();

}  // namespace weft::host
