// SPDX-License-Identifier: Apache-2.0
#include "address.hpp"

#include <string_view>
#include <weft/core/quote.hpp>

#include "common/network_address.hpp"

namespace weft::stream {

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
  constexpr std::size_t kScheme = 6;
  const auto place = network::parse_address(std::string_view(text).substr(kScheme), 1);
  if (!place) return refuse(place.error().message);
  address.host = place->host;
  address.port = place->port;
  return address;
}

}  // namespace weft::stream
