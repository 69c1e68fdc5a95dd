// SPDX-License-Identifier: Apache-2.0
#include "address.hpp"

#include <boost/asio/error.hpp>
#include <charconv>
#include <weft/core/quote.hpp>

namespace weft::stream {

namespace asio = boost::asio;

Result<Address> parse_address(const std::string& text) {
  const auto refuse = [&](const std::string& why) {
    return Error{Errc::invalid_value,
                 quote(text) + " " + why +
                     "; write tcp://127.0.0.1:5005 or udp://127.0.0.1:5005, and 'path' for a "
                     "file, a named pipe or /dev/stdout"};
  };
  Address address;
  if (text.starts_with("udp://")) {
    address.protocol = Protocol::udp;
  } else if (!text.starts_with("tcp://")) {
    return refuse("begins neither with tcp:// nor with udp://");
  }
  const std::size_t colon = text.rfind(':');
  std::string host = colon > 6 ? text.substr(6, colon - 6) : std::string();
  const char *digits = text.data() + colon + 1, *end = text.data() + text.size();
  const auto [last, failed] = std::from_chars(digits, end, address.port);
  if (failed != std::errc() || last != end || address.port == 0) {
    return refuse("has no port from 1 to 65535 at its end");
  }
  if (host == "localhost") host = "127.0.0.1";
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  boost::system::error_code code;
  address.host = asio::ip::make_address(host, code);
  if (code) return refuse("has no address in numbers, such as 127.0.0.1 or [::1]");
  return address;
}

Error address_error(const std::string& text, const boost::system::error_code& code) {
  std::string advice;
  if (code == asio::error::address_in_use)
    advice = ": another program has this port, choose another";
  if (code == asio::error::access_denied) advice = ": choose a port from 1024 on";
  if (code == boost::system::errc::address_not_available) {
    advice = ": this machine has another address, choose one of its own";
  }
  return {Errc::io, text + " cannot be used (" + code.message() + ")" + advice, {}};
}

}  // namespace weft::stream
