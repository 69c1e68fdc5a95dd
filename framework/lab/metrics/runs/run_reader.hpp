// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>
#include <weft/data/visibility.hpp>
#include <weft/data/warp.hpp>

#include "host/records/npz.hpp"
#include "lab/metrics/runs/run_registrations.hpp"

namespace weft::lab {

/// The line of a frame in frames.jsonl.
struct FrameLine {
  std::uint64_t frame = 0;  ///< [] index from 0
  std::string stem;         ///< stem of the image file, empty where there is none
  ShapeState state = ShapeState::none;
  bool failed = false;  ///< a stage, the source or a sink had an error
  /// [] in the frame's file, which exists unless this is 0; -1: not in the line
  std::int64_t records = -1;
};

/// The matches of a stage that a filter kept.
struct FilterRecords {
  std::string stage;
  Array<std::uint8_t> before, after;  ///< [N] 1 where kept
  Array<double> score;                ///< [N] of the filter
};

/// The matches of a stage, finite and on the mesh, and the filters that they went through.
struct MatchRecords {
  std::string stage;
  Correspondences matches;
  Array<float> depth_m;  ///< [N] m, true depth at each match, 0 where unknown; absent without any
  std::vector<FilterRecords> filters;  ///< in the order of the stages
};

/// Where the warp of a stage takes the template's vertices.
struct WarpRecords {
  std::string stage;
  WarpSamples samples;  ///< one a vertex; may be NaN
};

/// The records of one frame; the record structs borrow from `owners`.
struct FrameRecords {
  std::optional<Shape> shape;            ///< vertices may be NaN: that is for the reader to count
  std::optional<Visibility> visibility;  ///< output of the last pass that estimates it
  std::optional<Registration> registration;  ///< measured later, else by the last pass that does
  std::optional<GroundTruth> ground_truth;   ///< finite
  std::vector<MatchRecords> matches;         ///< in the order of the stages
  std::vector<WarpRecords> warps;            ///< in the order of the stages
  host::NamedRecords owners;
};

/// Adds "filters/tran: reconstruction" once, for a solver, a warp or a filter that states how it
/// relates to its reference.
void add_implements(const std::string& id, const std::string& word,
                    std::vector<std::string>& implements);

/// The folder that a run wrote, opened for reading.
class RunReader {
 public:
  /// Reads everything but the frames. Fails with not_found where the folder is no run folder, with
  /// syntax or invalid_data and the place where a file is damaged or lines are missing.
  static Result<RunReader> open(const std::string& folder);

  /// A run that is not written: `where` names it in errors, `scene` has the slots template and
  /// camera. It has no lines and no truth users.
  static Result<RunReader> in_memory(const std::string& where, host::NamedRecords scene);

  const std::string& folder() const { return folder_; }
  const Template& sheet() const { return template_; }
  const Camera& camera() const { return camera_; }
  /// One entry a frame, in the order of the frames.
  const std::vector<FrameLine>& lines() const { return lines_; }
  /// The run did not come to its end: it was killed or stopped. A line that was cut off then is not
  /// among lines().
  bool interrupted() const { return interrupted_; }
  /// It was killed, or the machine lost its power: files of its last frames may not be whole.
  bool killed() const { return killed_; }
  /// Unknown parts of the run because a file of the folder is missing or damaged.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// [frames] of the source; -1 if unknown.
  std::int64_t source_frames() const { return source_frames_; }
  /// [frames] of the source that the run omitted between its own, with `realtime: latest`.
  std::int64_t dropped() const { return dropped_; }
  /// Else frames are unordered images.
  bool is_sequence() const { return is_sequence_; }
  /// Without a solver there are no shapes, and none is missing.
  bool has_solver() const { return has_solver_; }
  /// Components of the run that may read the ground truth: their results are no measurement.
  const std::vector<std::string>& truth_users() const { return truth_users_; }
  /// Solvers, warps and filters that state how they relate to their reference:
  /// "filters/tran: reconstruction".
  const std::vector<std::string>& implements() const { return implements_; }

  /// Shape, truth and matches of one frame. Fails where its file is damaged, contradicts its line
  /// or has a shape of another mesh.
  Result<FrameRecords> read(const FrameLine& line) const;

  /// The same from records that are at hand, with slots as in frames/NNNNNN.npz; `file` names them
  /// in errors.
  Result<FrameRecords> sort(host::NamedRecords records, const FrameLine& line,
                            const std::string& file) const;

 private:
  explicit RunReader(std::string folder) : folder_(std::move(folder)) {}
  Result<void> take_scene(host::NamedRecords scene, const std::string& file);
  Result<void> read_lines();
  Result<void> check_numbers();
  Result<void> read_manifest();
  Result<void> do_without_manifest(const Error& fault);
  Result<void> read_end(const std::string& file);

  std::string folder_;
  host::NamedRecords template_owner_;
  Template template_;
  Camera camera_;
  std::vector<FrameLine> lines_;
  std::optional<MeasuredFrames> measured_;  ///< used instead of the measurements of stages
  bool interrupted_ = false;
  bool killed_ = false;
  bool may_drop_ = false;
  bool is_sequence_ = true;
  std::int64_t source_frames_ = -1;
  std::int64_t dropped_ = 0;
  bool cut_ = false;  ///< the last line has no line break
  bool has_solver_ = true;
  std::vector<std::string> truth_users_;
  std::vector<std::string> implements_;
  std::vector<std::string> warnings_;
};

}  // namespace weft::lab
