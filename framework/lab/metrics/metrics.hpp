// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/visibility.hpp>

#include "lab/metrics/run_metrics.hpp"

namespace weft::lab {

class RunReader;
struct FrameLine;
struct FrameRecords;

/// Compares a solved frame with its flat reference; nothing where it cannot be compared. The record
/// is valid until the next call.
using MeasureRegistration = std::function<Result<std::optional<Registration>>(
    const FrameLine& line, const FrameRecords& records)>;

struct EvaluationOptions {
  Alignment alignment = Alignment::none;
  double match_tolerance_px = 2.0;   ///< [] px, a match this near its true place is correct
  std::int64_t surface_samples = 0;  ///< [] points sampled for sampled distances; 0: no such
                                     ///< figures
  MeasureRegistration measure_registration = {};  ///< instead of the run's own registration
};

/// Evaluates a run folder against the ground truth in it; changes nothing. A run without truth has
/// counts, strains and jitter only. Fails where the folder is no run folder or files in it are
/// damaged; the Error names the first and counts them.
Result<RunMetrics> evaluate_run(const std::string& folder, const EvaluationOptions& options = {});

/// The same, frame by frame, of a run that need not be written.
class RunEvaluator {
 public:
  /// `scene` has the template and the camera, and must outlive this. Frames that are no sequence
  /// have no jitter and no cuts. Fails on a template that cannot be measured.
  static Result<RunEvaluator> create(const RunReader& scene, const EvaluationOptions& options,
                                     bool is_sequence = true);

  RunEvaluator(RunEvaluator&& other) noexcept;
  RunEvaluator& operator=(RunEvaluator&& other) noexcept;
  ~RunEvaluator();

  /// Frames in their order.
  Result<void> add(const FrameLine& line, const FrameRecords& records);

  const std::vector<FrameMetrics>& frames() const;

  /// The metrics of all frames; ends the evaluation. Without a solver no shape is missing. The
  /// caller fills in `run` and the contents of the run folder.
  RunMetrics finish(bool has_solver);

 private:
  struct State;
  explicit RunEvaluator(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace weft::lab
