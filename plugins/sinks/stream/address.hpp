// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ip/address.hpp>
#include <cstdint>
#include <string>
#include <weft/core/result.hpp>

namespace weft::stream {

enum class Protocol { tcp, udp };

struct Address {
  Protocol protocol = Protocol::tcp;
  boost::asio::ip::address host;
  std::uint16_t port = 0;
};

/// The address in `tcp://127.0.0.1:5005`, `udp://[::1]:5005`, `tcp://localhost:5005`. Names are not
/// looked up.
Result<Address> parse_address(const std::string& text);

}  // namespace weft::stream
