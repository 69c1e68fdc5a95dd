// SPDX-License-Identifier: Apache-2.0
#include "line_pipe.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <weft/core/index.hpp>

namespace weft::known_points {
namespace {

constexpr std::size_t kLongestLine = 65536;  // bytes
constexpr int kAskEvery_ms = 5;

}  // namespace

LinePipe::Descriptor::~Descriptor() {
  if (number_ >= 0) ::close(number_);
}

Result<LinePipe> LinePipe::open(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file >= 0) return LinePipe(file);
  return Error{Errc::io, path + ": " + std::strerror(errno)};
}

bool LinePipe::take_line(std::string& line) {
  const std::size_t end = buffer_.find('\n');
  if (end == std::string::npos && (!ended_ || buffer_.empty())) return false;
  line = buffer_.substr(0, end);
  buffer_.erase(0, end == std::string::npos ? end : end + 1);
  return true;
}

/// Appends what can be had within a moment.
Result<void> LinePipe::receive() {
  pollfd waiting{file_.number(), POLLIN, 0};
  if (::poll(&waiting, 1, kAskEvery_ms) <= 0) return {};
  if ((waiting.revents & POLLIN) == 0) {  // a pipe that had no writer yet would not have woken up
    ended_ = true;
    return {};
  }
  std::array<char, 4096> chunk{};
  const ssize_t count = ::read(file_.number(), chunk.data(), chunk.size());
  if (count > 0) buffer_.append(chunk.data(), to_index(count));
  if (count == 0) ended_ = true;
  if (count >= 0 || errno == EAGAIN || errno == EINTR) return {};
  ended_ = true;
  return Error{Errc::io, std::strerror(errno)};
}

Result<LinePipe::Got> LinePipe::next(std::string& line,
                                     std::chrono::steady_clock::time_point deadline,
                                     const std::function<bool()>& cancelled) {
  while (!take_line(line)) {
    if (ended_) return Got::end;
    if (buffer_.size() > kLongestLine) {
      buffer_.clear();
      ended_ = true;
      return Error{Errc::invalid_data, "a line is longer than 64 KiB"};
    }
    if (cancelled()) return Got::cancelled;
    if (auto received = receive(); !received) return received.error();
    const bool late = std::chrono::steady_clock::now() >= deadline;
    if (late && buffer_.find('\n') == std::string::npos && !ended_) return Got::nothing;
  }
  return Got::line;
}

}  // namespace weft::known_points
