// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/network_address.hpp"
#include "hub.hpp"

namespace weft::live {

/// HTTP and WebSockets at one port, served by a separate thread.
class Server {
 public:
  virtual ~Server() = default;
  /// The actual port, where the requested one is 0.
  virtual std::uint16_t port() const = 0;
  /// Lets clients have the newest frame and ends them all, within Limits::end.
  virtual void finish() = 0;
};

/// Listens from now on. `exchange` outlives the server.
Result<std::unique_ptr<Server>> start_server(const network::Address& address, LiveSetup setup,
                                             RunChannel& run_channel);

}  // namespace weft::live
