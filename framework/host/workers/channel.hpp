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
  std::uint64_t call = 0;  ///< number of the call that it requests, answers or concerns
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

  /// Waits for a message. `keep_waiting` is called each time the socket's own timeout expires
  /// (SO_RCVTIMEO); empty waits for ever. For one thread.
  Received receive(Message& message, const std::function<bool()>& keep_waiting = {});

  /// Informs the other end that no more messages follow.
  void finish();

 private:
  Received read(char* target, std::size_t size, const std::function<bool()>& keep_waiting);
  ssize_t read_some();

  int socket_;
  std::array<char, 8192> buffer_{};
  std::string_view ahead_{};  ///< part of the buffer that no caller has consumed
  int short_waits_ = 0;       ///< asleep, since the last long one
  std::mutex sending_;
};

}  // namespace weft::host
