// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ip/address.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <weft/core/result.hpp>

namespace weft::network {

struct Address {
  boost::asio::ip::address host;
  std::uint16_t port = 0;
};

/// The address in `127.0.0.1:5005`, `[::1]:5005`, `localhost:5005`. Names are not looked up. The
/// error is the end of a sentence about the text.
Result<Address> parse_address(std::string_view text, std::uint16_t least_port);

/// An error about the address `text` with a suggestion, where there is one.
Error address_error(const std::string& text, const boost::system::error_code& code);

}  // namespace weft::network
