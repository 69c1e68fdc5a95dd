// SPDX-License-Identifier: Apache-2.0
#include "common/network_address.hpp"

#include <boost/asio/error.hpp>
#include <charconv>

namespace weft::network {

namespace asio = boost::asio;

Result<Address> parse_address(std::string_view text, std::uint16_t least_port) {
  Address address;
  const std::size_t colon = text.rfind(':');
  const std::string_view digits = colon == text.npos ? std::string_view() : text.substr(colon + 1);
  const char* end = digits.data() + digits.size();
  const auto [last, failed] = std::from_chars(digits.data(), end, address.port);
  if (failed != std::errc() || last != end || address.port < least_port) {
    return Error{Errc::invalid_value,
                 "has no port from " + std::to_string(least_port) + " to 65535 at its end"};
  }
  std::string host(text.substr(0, colon));
  if (host == "localhost") host = "127.0.0.1";
  const bool has_brackets = host.starts_with('[') && host.ends_with(']');
  if (has_brackets) host = host.substr(1, host.size() - 2);
  boost::system::error_code code;
  address.host = asio::ip::make_address(host, code);
  // Without brackets, the last part of an IPv6 address cannot be distinguished from a port.
  if (!code && address.host.is_v6() == has_brackets) return address;
  return Error{Errc::invalid_value, "has no address in numbers, such as 127.0.0.1 or [::1]"};
}

Error address_error(const std::string& text, const boost::system::error_code& code) {
  std::string advice;
  if (code == asio::error::address_in_use)
    advice = ": another program has this port, choose another";
  if (code == asio::error::access_denied) advice = ": choose a port from 1024 on";
  if (code == boost::system::errc::address_not_available) {
    advice = ": this machine has another address, choose one that it has";
  }
  return {Errc::io, text + " cannot be used (" + code.message() + ")" + advice, {}};
}

}  // namespace weft::network
