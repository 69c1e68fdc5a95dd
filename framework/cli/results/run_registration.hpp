// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "lab/metrics/metrics.hpp"
#include "lab/metrics/runs/run_registrations.hpp"
#include "pipeline/execution/input.hpp"

namespace weft::cli {

/// Arguments of --flat-reference.
struct FlatReference {
  bool wanted = false;
  std::string words;                  ///< file of words; empty: cells of a grid
  std::vector<std::string> settings;  ///< NAME=VALUE, parameters of the pass
};

/// Compares the images of a finished run with its shapes: reads the images again and calls the pass
/// that --flat-reference stands for.
class RunRegistration {
 public:
  /// Fails with the first error in the run's pipeline or in `reference`, if the source cannot be
  /// opened, and if it is live, because its images are gone.
  static Result<std::unique_ptr<RunRegistration>> open(const std::string& folder,
                                                       const FlatReference& reference,
                                                       const host::Registry& registry);

  /// The registration of a frame with a shape, which is measured once; nothing where its image
  /// cannot be read. Frames in their order. Fails where the source gives no image, and with the
  /// error of the pass.
  Result<std::optional<Registration>> measure(const lab::FrameLine& line,
                                              const lab::FrameRecords& records);

  const lab::MeasuredFrames& measured() const { return measured_; }

 private:
  Result<void> open_source(const std::string& folder);
  Result<host::RecordPtr> measure(std::uint64_t frame, const host::Record& shape);

  PipelineConfig config_;
  host::ComponentSpec spec_;
  std::unique_ptr<host::ExecutionContext> context_;
  std::optional<PipelineInput> input_;
  host::RecordPtr template_;
  host::Instance* pass_ = nullptr;
  lab::MeasuredFrames measured_;
};

}  // namespace weft::cli
