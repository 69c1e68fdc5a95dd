// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <weft/core/result.hpp>

#include "line_pipe.hpp"
#include "point_tracks.hpp"

namespace weft::known_points {

struct FeedOptions {
  std::string path;          ///< .csv, other files and named pipes: JSON lines
  double tolerance_s = 0.1;  ///< [] s
  int wait_ms = 200;         ///< [] ms, of one frame for a pipe
  Eigen::Isometry3d camera_from_rows = Eigen::Isometry3d::Identity();
};

/// True if a named pipe of this name exists.
bool is_pipe(const std::string& path);

/// When a frame is.
struct Moment {
  double frame = 0.0;            ///< []
  std::optional<double> time_s;  ///< [] s, by the clock of the rows
};

/// Rows of a file, which is read at once, or of a named pipe, which is read as frames need it.
class RowFeed {
 public:
  /// Fails on a file that cannot be read or has an error, with its place.
  static Result<RowFeed> open(FeedOptions options);

  /// The points at a moment. From a pipe it reads rows up to the first one later than the moment;
  /// where they do not come, the result is flagged. A row with an error is reported as an error
  /// once, and omitted.
  Result<std::optional<KnownPoints>> at(const Moment& moment,
                                        const std::function<bool()>& cancelled);

 private:
  explicit RowFeed(FeedOptions options)
      : options_(std::move(options)), tracks_(options_.tolerance_s) {}

  Result<void> read_csv(const std::string& text);
  Result<void> read_json_lines(const std::string& text);
  Result<void> add(Result<PointRow> row, int line_number);
  Result<std::string> receive(const Moment& moment, const std::function<bool()>& cancelled);
  bool is_past(const Moment& moment) const;
  bool has_reached(const Moment& moment) const;
  double wanted(const Moment& moment) const;

  FeedOptions options_;
  PointTracks tracks_;
  std::optional<LinePipe> pipe_;
  int pipe_line_ = 0;
};

}  // namespace weft::known_points
