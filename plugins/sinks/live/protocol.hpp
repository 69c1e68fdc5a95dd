// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "hub.hpp"

namespace weft::live {

/// One message of a WebSocket.
struct Outgoing {
  std::string head;  ///< the part for this client alone
  Text body;         ///< the rest of the message; never null
  bool is_text = true;
};

inline Outgoing text_message(std::string text) {
  return {{}, std::make_shared<const std::string>(std::move(text)), true};
}

/// The messages on a WebSocket. The connection requests the next message when the last one is sent,
/// so that no messages queue up for a client that does not read.
class Protocol {
 public:
  virtual ~Protocol() = default;
  virtual std::optional<Outgoing> next() = 0;
  /// Handles a message of the client; the result is empty, or the reason for closing the
  /// connection.
  virtual std::string receive(std::string_view message, bool is_text) = 0;
  virtual void take_answer(const ClientAnswer& /*answer*/) {}
  /// True if the client may send more before it has read the messages that wait for it.
  virtual bool takes_more() const = 0;
  /// True if the client has received the newest frame.
  virtual bool is_served() const = 0;
};

constexpr std::string_view kLiveProtocol = "weft.live.1";
constexpr std::string_view kFoxgloveProtocol = "foxglove.websocket.v1";
/// The name under which newer Foxglove clients offer the same protocol.
constexpr std::string_view kFoxgloveSdkProtocol = "foxglove.sdk.v1";

std::unique_ptr<Protocol> speak_live(Hub& hub, ClientId client);
std::unique_ptr<Protocol> speak_foxglove(Hub& hub);

}  // namespace weft::live
