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

/// A file, a named pipe that somebody reads, or /dev/stdout. Each message is written; who reads a
/// pipe slowly holds `send` back, until the call is cancelled. What failed once stays failed.
MadeOutlet open_path(const std::string& path);

/// Listens. Whoever connects is sent the newest message, and later ones as fast as it reads: what
/// it is too slow for is left out. `send` waits for nobody, `finish` for at most half a second.
MadeOutlet listen_at(const Address& address, const std::string& name);

/// One datagram for each message, to an address where somebody may listen or not.
MadeOutlet send_to(const Address& address, const std::string& name);

}  // namespace weft::stream
