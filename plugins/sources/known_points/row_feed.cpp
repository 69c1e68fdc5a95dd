// SPDX-License-Identifier: Apache-2.0
#include "row_feed.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <weft/core/text_file.hpp>

#include "row_text.hpp"

namespace weft::known_points {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_blank(std::string_view line) { return line.find_first_not_of(" \t\r") == line.npos; }

std::string_view without_return(std::string_view line) {
  return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
}

/// Calls `take(line, number)` for each line that is not blank, until one fails.
template <class Take>
Result<void> for_each_line(std::string_view text, const Take& take) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = without_return(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (is_blank(line)) continue;
    if (Result<void> taken = take(line, number); !taken) return taken;
  }
  return {};
}

}  // namespace

bool is_pipe(const std::string& path) {
  std::error_code code;
  return std::filesystem::is_fifo(path, code);
}

Result<RowFeed> RowFeed::open(FeedOptions options) {
  RowFeed feed(std::move(options));
  const std::string& path = feed.options_.path;
  if (is_pipe(path)) {
    auto pipe = LinePipe::open(path);
    if (!pipe) return pipe.error();
    feed.pipe_ = *std::move(pipe);
    return feed;
  }
  constexpr std::uint64_t kMostBytes = 1U << 28U;
  const auto text = read_text_file(path, kMostBytes);
  if (!text) {
    return Error{text.error().code, path + ": cannot be read: " + text.error().message};
  }
  const bool is_csv = std::filesystem::path(path).extension() == ".csv";
  auto read = is_csv ? feed.read_csv(*text) : feed.read_json_lines(*text);
  if (!read) return read.error();
  if (feed.tracks_.empty()) return Error{Errc::invalid_data, path + ": has no rows"};
  return feed;
}

Result<void> RowFeed::read_csv(const std::string& text) {
  CsvReader reader(options_.path);
  bool has_header = false;
  return for_each_line(text, [&](std::string_view line, int number) -> Result<void> {
    if (has_header) return add(reader.read(line, number), number);
    has_header = true;
    return reader.read_header(line, number);
  });
}

Result<void> RowFeed::read_json_lines(const std::string& text) {
  return for_each_line(text, [&](std::string_view line, int number) {
    return add(read_json_row(options_.path, line, number), number);
  });
}

Result<void> RowFeed::add(Result<PointRow> row, int line_number) {
  if (!row) return row.error();
  row->point_m = options_.camera_from_rows * row->point_m;
  if (!(row->point_m.z() > 0.0)) {
    return mistake_at(options_.path, line_number, 1,
                      "the point is not before the camera, which looks along +z: z is " +
                          std::to_string(1e3 * row->point_m.z()) + " mm");
  }
  const auto added = tracks_.add(*row);
  if (added) return {};
  return mistake_at(options_.path, line_number, 1, added.error().message);
}

double RowFeed::wanted(const Moment& moment) const {
  return tracks_.by_frame() ? moment.frame : *moment.time_s;
}

bool RowFeed::is_past(const Moment& moment) const {
  return !tracks_.empty() && tracks_.newest() > wanted(moment);
}

bool RowFeed::has_reached(const Moment& moment) const {
  return !tracks_.empty() && tracks_.newest() >= wanted(moment);
}

/// Why rows are missing, or nothing.
Result<std::string> RowFeed::receive(const Moment& moment, const std::function<bool()>& cancelled) {
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::milliseconds(options_.wait_ms);
  std::string line;
  while (!is_past(moment)) {
    const auto got = pipe_->next(line, deadline, cancelled);
    if (!got) return Error{got.error().code, options_.path + ": " + got.error().message};
    if (*got == LinePipe::Got::cancelled) return Error{Errc::cancelled, "cancelled"};
    if (*got == LinePipe::Got::end && has_reached(moment)) return std::string();
    const std::string last = tracks_.empty()
                                 ? "no row has come"
                                 : "the last row has time " + std::to_string(tracks_.newest()) +
                                       ", the frame of " + std::to_string(wanted(moment));
    if (*got == LinePipe::Got::end) return "the pipe has ended: " + last;
    if (*got == LinePipe::Got::nothing) {
      return "the pipe was silent for " + std::to_string(options_.wait_ms) + " ms: " + last;
    }
    ++pipe_line_;
    if (is_blank(line)) continue;
    const auto row = read_json_row(options_.path, without_return(line), pipe_line_);
    if (auto added = add(row, pipe_line_); !added) return added.error();
    if (!tracks_.by_frame() && !moment.time_s) break;
  }
  return std::string();
}

Result<std::optional<KnownPoints>> RowFeed::at(const Moment& moment,
                                               const std::function<bool()>& cancelled) {
  std::string late;
  const bool has_moment = tracks_.empty() || tracks_.by_frame() || moment.time_s;
  if (pipe_ && has_moment) {
    auto received = receive(moment, cancelled);
    if (!received) return received.error();
    late = *std::move(received);
  }
  std::optional<KnownPoints> known;
  if (!tracks_.empty()) {
    if (!tracks_.by_frame() && !moment.time_s) {
      return Error{Errc::invalid_data,
                   "the frame has no time: give the rows a 'frame' instead of 'time_s'"};
    }
    known = tracks_.at(wanted(moment));
    if (pipe_) tracks_.forget_before(wanted(moment));
  }
  if (!late.empty()) return degenerate(std::move(known), late);
  return known;
}

}  // namespace weft::known_points
