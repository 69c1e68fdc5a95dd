// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lab/ablation/engine.hpp"
#include "process/child.hpp"

namespace weft::lab {

/// Starts a process that runs these cells and writes their results. It dies with this one, together
/// with all processes that components start (process/supervisor.hpp). The output of components and
/// libraries goes into the log of the results folder.
///
/// The process is a fork, so that the plan need not be read again: this one has loaded no plugin
/// and must have no threads.
Result<std::unique_ptr<process::Child>> start_child(const Order& order,
                                                    const std::vector<const Cell*>& cells);

/// True if a child ended by its own fault, such as an exit or a signal that a program sends itself
/// after an error. Any other signal comes from outside.
bool is_own_fault(const process::Ending& ending);
std::string how_it_ended(const process::Ending& ending);

/// A message of a child.
struct ChildMessage {
  std::optional<double> share;                              ///< share of its frames that are done
  std::string error;                                        ///< why results could not be kept
  std::optional<std::pair<std::string, std::string>> left;  ///< a cell without a result, and why
  bool no_memory = false;                                   ///< this program had not enough of it
  bool done = false;                                        ///< all results are kept
};
ChildMessage parse_message(const std::string& line);

}  // namespace weft::lab
