// SPDX-License-Identifier: Apache-2.0
#include "host/workers/channel.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <weft/core/index.hpp>

namespace weft::host {
namespace {

struct Header {
  std::uint32_t mark;
  std::uint32_t kind;
  std::uint64_t length;
};

constexpr std::uint32_t kMark = 0x54464557;  // "WEFT"
constexpr std::uint64_t kLongestMessage_bytes = 64U << 20U;
constexpr int kSlice_ms = 10;

}  // namespace

Channel::~Channel() { close(socket_); }

void Channel::finish() { shutdown(socket_, SHUT_WR); }

bool Channel::send(MessageKind kind, std::string_view content) {
  const Header header{kMark, static_cast<std::uint32_t>(kind), content.size()};
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof(header));
  bytes += content;
  const std::lock_guard lock(sending_);
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    sent += to_index(count);
  }
  return true;
}

Channel::Received Channel::receive(Message& message, const std::function<bool()>& keep_waiting) {
  Header header{};
  Received got = read(reinterpret_cast<char*>(&header), sizeof(header), keep_waiting);
  if (got != Received::message) return got;
  if (header.mark != kMark || header.length > kLongestMessage_bytes) return Received::unreadable;
  message.kind = static_cast<MessageKind>(header.kind);
  message.content.resize(header.length);
  return read(message.content.data(), header.length, keep_waiting);
}

Channel::Received Channel::read(char* target, std::size_t size,
                                const std::function<bool()>& keep_waiting) {
  for (std::size_t got = 0; got < size;) {
    pollfd waiting{socket_, POLLIN, 0};
    if (poll(&waiting, 1, keep_waiting ? kSlice_ms : -1) > 0) {
      const ssize_t count = recv(socket_, target + got, size - got, MSG_DONTWAIT);
      if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) return Received::closed;
      got += to_index(std::max<ssize_t>(count, 0));
    }
    // Asked for a slow stream of bytes too.
    if (got < size && keep_waiting && !keep_waiting()) return Received::gave_up;
  }
  return Received::message;
}

}  // namespace weft::host
