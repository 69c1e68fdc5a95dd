// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/dumps/dump.hpp"

namespace weft {

/// Outcome of a dumped call when it was made again.
struct Replayed {
  host::Outcome outcome;
  std::vector<double> ms;  ///< [ms] of each repetition, nested components included
  /// A sentence for the status and for each array that is not what the dump holds, bit for bit.
  std::vector<std::string> differences;
};

/// A stage alone, with the components nested in it and those that evaluate the warps that it reads.
/// It runs in this process, also when the dumped one did not.
class Replay {
 public:
  /// `params` is a YAML map that overrides dumped parameters; empty for none. Fails with
  /// invalid_value for errors in it, and with the errors of creating and preparing the components.
  static Result<std::unique_ptr<Replay>> create(const host::Registry& registry,
                                                const DumpedStage& stage,
                                                const std::string& params);

  /// Compares records of vendors with the declaration of the component; those of others are always
  /// valid in a dump.
  Result<void> check(const StageCall& call) const;

  /// Makes a call again, `repeat` times; a difference in any repetition is reported.
  Replayed run(const StageCall& call, int repeat);

  /// True if the plugin is another build than the one that was dumped.
  bool is_rebuilt() const { return is_rebuilt_; }

 private:
  explicit Replay(std::uint64_t seed) : context_(seed, {}) {}
  Result<host::Instance*> make(const DumpedStage& stage, const std::string& name,
                               host::ComponentSpec spec);

  std::deque<host::ComponentSpec> specs_;
  host::ExecutionContext context_;
  host::Instance* instance_ = nullptr;
  std::map<std::string, std::uint64_t> producers_;  ///< handles by stage
  bool is_rebuilt_ = false;
};

/// Differences between two outcomes of the same call: "out.shape/vertices_m: 3 of 87 values differ,
/// by at most 1e-5". Empty when status, reason and all arrays are the same bit for bit.
std::vector<std::string> differences(const host::Outcome& before, const host::Outcome& after);

/// The folder of a stage's dump: `records` is that folder, a file in it, the folder "dumps" or the
/// run folder. Fails with not_found when it belongs to another stage, with io when there is no
/// dump.
Result<std::string> find_dump(const std::string& records, const std::string& stage);

}  // namespace weft
