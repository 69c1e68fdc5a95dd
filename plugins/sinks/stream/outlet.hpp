// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <weft/sdk/call.hpp>

#include "address.hpp"

namespace weft::stream {

/// Where messages go.
class Outlet {
 public:
  virtual ~Outlet() = default;
  /// One message, whole.
  virtual Result<void> send(std::string message, const Call& call) = 0;
  /// After the last message: gives readers a moment to get it.
  virtual void finish() = 0;
};

using MadeOutlet = Result<std::unique_ptr<Outlet>>;

/// A file, a named pipe with a reader, or /dev/stdout. Each message is written; a slow reader of a
/// pipe blocks `send`, until the call is cancelled. After a failure, all later calls fail.
MadeOutlet open_path(const std::string& path);

/// Listens. Each client receives the newest message when it connects, and later ones as fast as it
/// reads; those that it is too slow for are omitted. `send` never waits, and `finish` waits at most
/// half a second.
MadeOutlet listen_at(const Address& address, const std::string& name);

/// Sends one datagram for each message to an address, with or without a listener.
MadeOutlet send_to(const Address& address, const std::string& name);

}  // namespace weft::stream
