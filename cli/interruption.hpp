// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace weft::cli {

/// From now on SIGINT and SIGTERM set this flag instead of ending the process.
const std::atomic<bool>& watch_for_interruption();

}  // namespace weft::cli
