// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <array>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "host/workers/message.hpp"

namespace weft::host {

struct Message {
  MessageKind kind{};
  std::uint64_t call = 0;  ///< which one it asks for, answers or speaks of
  std::string content;
};

/// One end of the socket between a host and a worker. It closes the socket.
class Channel {
 public:
  enum class Received { message, closed, unreadable, gave_up };

  explicit Channel(int socket) : socket_(socket) {}
  ~Channel();
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  int socket() const { return socket_; }

  /// From any thread; false when the other end is gone or does not read.
  bool send(MessageKind kind, std::string_view content, std::uint64_t call);

  /// Waits for a message. `keep_waiting` is asked whenever the socket's own patience is at its end
  /// (SO_RCVTIMEO); empty waits for ever. For one thread.
  Received receive(Message& message, const std::function<bool()>& keep_waiting = {});

  /// Tells the other end that nothing more will come.
  void finish();

 private:
  Received read(char* target, std::size_t size, const std::function<bool()>& keep_waiting);
  ssize_t read_some();

  int socket_;
  std::array<char, 8192> buffer_{};
  std::string_view ahead_{};  ///< of the buffer, not yet asked for
  int short_waits_ = 0;       ///< asleep, since the last long one
  std::mutex sending_;
};

}  // namespace weft::host
