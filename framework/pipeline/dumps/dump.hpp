// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/execution/executor.hpp"

namespace weft {

/// Everything needed to call a dumped stage again, except its inputs.
struct DumpedStage {
  std::string folder;
  std::string name;        ///< name of the stage
  std::uint64_t seed = 0;  ///< seed of the run
  std::string build_id;    ///< build id of the library that ran
  yaml::Node component;    ///< {use, params}, all defaults filled in
  std::vector<std::pair<std::string, yaml::Node>> producers;  ///< stages that make warps, alike
  host::RecordPtr templ;
  host::RecordPtr camera;
};

/// The folders dumps/STAGE of a run: stage.yaml and template.npz contain the fields of DumpedStage,
/// and each NNNNNN.npz contains one call, which is one frame. Its slots are `in.<slot>` and
/// `out.<slot>`, with `#2`, `#3` ... from the second record of a slot on. `call` has frame, status,
/// reason, and under `inputs` a line "slot record producer" for each input in order. Template and
/// camera are the same in all calls and are stored only in template.npz.
class Dump {
 public:
  /// Fails with not_found when one of the names is no stage's.
  static Result<void> check_names(const PipelineConfig& config,
                                  const std::vector<std::string>& stages);

  /// Creates the folders; the names are legal.
  static Result<Dump> create(const std::string& run_folder, const PipelineConfig& config,
                             const std::vector<std::string>& stages, host::RecordPtr templ,
                             host::RecordPtr camera);

  /// Writes the calls that the frame keeps.
  Result<void> add(const FrameResult& frame) const;

 private:
  explicit Dump(std::string folder) : folder_(std::move(folder)) {}

  std::string folder_;
};

/// "000012.npz"
std::string dumped_call_name(std::uint64_t frame);

/// Writes one call, in the format of Dump.
Result<void> write_call(const std::string& file, const StageCall& call);

/// Reads a dumped stage. Fails with io, syntax or invalid_data.
Result<DumpedStage> read_dumped_stage(const std::string& folder);

/// Reads one call of a dumped stage. Fails with io or invalid_data.
Result<StageCall> read_call(const std::string& file, const DumpedStage& stage);

}  // namespace weft
