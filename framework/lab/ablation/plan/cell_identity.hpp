// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lab/ablation/plan/input_files.hpp"
#include "lab/ablation/plan/plan.hpp"
#include "pipeline/runs/run.hpp"

namespace weft::lab {

/// Keys that determine whether two cells, or two stages, do the same work; see docs/results.md for
/// their contents.
struct CellIdentity {
  std::string key;                  ///< key of the cell
  std::string rebuilt_key;          ///< the same without build ids
  std::string group;                ///< key of its inputs: source, template and their files
  std::vector<std::string> stages;  ///< a key for each stage, of it and all that it depends on
};

/// Part of a pipeline in the keys of its cells, as pieces of canonical JSON.
struct IdentityPart {
  std::string text;
  std::string rebuilt;  ///< the same without build ids
  bool seeded = false;  ///< it holds the run seed
};

/// The files that a pipeline reads, as its parameters name them.
std::vector<std::string> input_paths(const CheckedPipeline& pipeline);

/// Identifies cells; hashes each file once.
class Identifier {
 public:
  /// Files that cannot be read are appended to `problems`, at the parameter that names them; the
  /// identity is then not to be used.
  CellIdentity identify(const CheckedPipeline& pipeline, std::uint64_t run_seed,
                        const Measurement& measurement, std::vector<yaml::Problem>& problems);

  /// The same in two parts, which many cells share: source and template; all else. Joined they are
  /// the identity without the keys of the stages.
  IdentityPart data_part(const CheckedPipeline& pipeline, std::uint64_t run_seed,
                         std::vector<yaml::Problem>& problems);
  IdentityPart rest_part(const CheckedPipeline& pipeline, std::uint64_t run_seed,
                         const Measurement& measurement, std::vector<yaml::Problem>& problems);
  static CellIdentity join(const IdentityPart& data, const IdentityPart& rest);

  /// A key for each stage.
  std::vector<std::string> stage_keys(const CheckedPipeline& pipeline, std::uint64_t run_seed);

  /// All that was hashed so far.
  const InputFiles& files() const { return files_; }

 private:
  friend class IdentityWriter;
  InputFiles files_;
};

}  // namespace weft::lab
