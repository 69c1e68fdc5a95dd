// SPDX-License-Identifier: Apache-2.0
#include "host/workers/channel.hpp"

#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <weft/core/index.hpp>

namespace weft::host {
namespace {

struct Header {
  std::uint32_t mark;
  std::uint32_t kind;
  std::uint64_t call;
  std::uint64_t length;
};

constexpr std::uint32_t kMark = 0x54464557;  // "WEFT"
constexpr std::uint64_t kLongestMessage_bytes = 64U << 20U;
constexpr std::chrono::microseconds kSoon{100};  ///< a few times what waking a core takes
constexpr int kEnoughShortWaits = 16;

}  // namespace

Channel::~Channel() { close(socket_); }

void Channel::finish() { shutdown(socket_, SHUT_WR); }

bool Channel::send(MessageKind kind, std::string_view content, std::uint64_t call) {
  Header header{kMark, static_cast<std::uint32_t>(kind), call, content.size()};
  std::array<iovec, 2> parts{
      iovec{&header, sizeof(header)},
      iovec{const_cast<char*>(content.data()), content.size()}};  // it is only read
  msghdr message{};
  message.msg_iov = parts.data();
  message.msg_iovlen = parts.size();
  const std::lock_guard lock(sending_);
  while (parts[0].iov_len + parts[1].iov_len > 0) {
    const ssize_t count = sendmsg(socket_, &message, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    std::size_t sent = to_index(count);
    for (iovec& part : parts) {
      const std::size_t of_part = std::min(sent, part.iov_len);
      part.iov_base = static_cast<char*>(part.iov_base) + of_part;
      part.iov_len -= of_part;
      sent -= of_part;
    }
  }
  return true;
}

Channel::Received Channel::receive(Message& message, const std::function<bool()>& keep_waiting) {
  Header header{};
  Received got = read(reinterpret_cast<char*>(&header), sizeof(header), keep_waiting);
  if (got != Received::message) return got;
  if (header.mark != kMark || header.length > kLongestMessage_bytes) return Received::unreadable;
  message.kind = static_cast<MessageKind>(header.kind);
  message.call = header.call;
  message.content.resize(header.length);
  return read(message.content.data(), header.length, keep_waiting);
}

/// A header comes with what follows it: one wait for both.
Channel::Received Channel::read(char* target, std::size_t size,
                                const std::function<bool()>& keep_waiting) {
  for (std::size_t got = 0; got < size;) {
    if (ahead_.empty()) {
      const ssize_t count = read_some();
      if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) return Received::closed;
      ahead_ = {buffer_.data(), to_index(std::max<ssize_t>(count, 0))};
    }
    const std::size_t part = std::min(ahead_.size(), size - got);
    std::copy_n(ahead_.data(), part, target + got);
    ahead_.remove_prefix(part);
    got += part;
    // Also called for a slow stream of bytes, not only for an idle one.
    if (got < size && keep_waiting && !keep_waiting()) return Received::gave_up;
  }
  return Received::message;
}

/// Awake for a moment where messages have come that soon. Where both ends share a core, being awake
/// only keeps the other one waiting: that is tried rarely.
ssize_t Channel::read_some() {
  const auto start = std::chrono::steady_clock::now();
  const auto is_soon = [&] { return std::chrono::steady_clock::now() - start < kSoon; };
  while (short_waits_ >= kEnoughShortWaits && is_soon()) {
    const ssize_t count = recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (count >= 0 || errno != EAGAIN) return count;
  }
  const ssize_t count = recv(socket_, buffer_.data(), buffer_.size(), 0);
  const int reason = errno;
  short_waits_ = is_soon() ? short_waits_ + 1 : 0;
  errno = reason;
  return count;
}

}  // namespace weft::host
