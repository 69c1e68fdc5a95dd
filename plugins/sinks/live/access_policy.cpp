// SPDX-License-Identifier: Apache-2.0
#include "access_policy.hpp"

#include <algorithm>
#include <boost/asio/ip/address.hpp>

namespace weft::live {
namespace {

namespace asio = boost::asio;

constexpr std::size_t kLeastToken = 16;
constexpr std::string_view kBearer = "Bearer ", kTokenMember = "token=", kScheme = "http://";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_token_character(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '.' ||
         c == '_' || c == '~';
}

std::string lower(std::string_view text) {
  std::string small(text);
  for (char& c : small) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return small;
}

/// Takes as long for each text of one length, however much of it is right.
bool are_same(std::string_view given, std::string_view secret) {
  unsigned difference = given.size() == secret.size() ? 0U : 1U;
  for (std::size_t i = 0; i < given.size(); ++i) {
    difference |= static_cast<unsigned>(static_cast<unsigned char>(given[i])) ^
                  static_cast<unsigned>(static_cast<unsigned char>(secret[i % secret.size()]));
  }
  return difference == 0;
}

/// The text behind `token=` in the query of a target; empty where there is none.
std::string_view query_token(std::string_view target) {
  const std::size_t question = target.find('?');
  std::string_view query = question == target.npos ? "" : target.substr(question + 1);
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view member = query.substr(0, end);
    if (member.starts_with(kTokenMember)) return member.substr(kTokenMember.size());
    query.remove_prefix(std::min(end + 1, query.size()));
  }
  return {};
}

/// The part of `127.0.0.1:8090` or `[::1]:8090` before the port, without brackets; empty where what
/// follows is no port.
std::string_view host_without_port(std::string_view host) {
  const bool has_brackets = host.starts_with('[');
  const std::size_t close = host.find(']');
  if (has_brackets && close == host.npos) return {};
  const std::size_t end = has_brackets ? close + 1 : std::min(host.find(':'), host.size());
  const std::string_view rest = host.substr(end);
  const bool is_port =
      rest.empty() || (rest[0] == ':' && std::all_of(rest.begin() + 1, rest.end(), is_digit));
  if (!is_port) return {};
  return has_brackets ? host.substr(1, end - 2) : host.substr(0, end);
}

}  // namespace

std::string_view path_of(std::string_view target) {
  return target.substr(0, std::min(target.find('?'), target.size()));
}

Result<void> AccessPolicy::check_token() const {
  if (token_.empty() && !listening_.is_loopback()) {
    return Error{Errc::invalid_value,
                 "a token is needed, because other machines can reach the address: give at least "
                 "16 random letters and digits, or take an address such as 127.0.0.1:8090"};
  }
  if (token_.empty()) return {};
  if (token_.size() >= kLeastToken &&
      std::all_of(token_.begin(), token_.end(), is_token_character)) {
    return {};
  }
  return Error{
      Errc::invalid_value,
      "the token must be at least 16 characters, each a letter, a digit or one of - . _ ~"};
}

Result<void> AccessPolicy::check_origin() const {
  const std::size_t scheme = origin_.find("://");
  const bool is_origin = scheme != origin_.npos && scheme > 0 &&
                         origin_.find('/', scheme + 3) == origin_.npos &&
                         origin_.find_first_of(" \t,") == origin_.npos;
  if (origin_.empty() || is_origin) return {};
  return Error{
      Errc::invalid_value,
      "the origin must be a scheme and a host, such as https://app.foxglove.dev, without a path"};
}

bool AccessPolicy::is_ours(std::string_view host) const {
  const std::string name = lower(host_without_port(host));
  if (name == "localhost") return true;
  boost::system::error_code code;
  const asio::ip::address address = asio::ip::make_address(name, code);
  // No page can be given an address in numbers for its name.
  return !code && (listening_.is_unspecified() || address == listening_);
}

bool AccessPolicy::has_token(const Visit& visit) const {
  const std::string_view said = visit.authorization;
  const bool has_header = lower(said.substr(0, kBearer.size())) == lower(kBearer);
  return are_same(has_header ? said.substr(kBearer.size()) : query_token(visit.target), token_);
}

std::optional<Refusal> AccessPolicy::refuse(const Visit& visit, bool needs_token) const {
  constexpr int kUnauthorized = 401, kForbidden = 403;
  if (!is_ours(visit.host)) {
    return Refusal{kForbidden,
                   "This server answers to its address in numbers and to localhost, not to other "
                   "names of this machine: open it by one of these."};
  }
  if (visit.origin && lower(*visit.origin) != std::string(kScheme) + lower(visit.host) &&
      (origin_.empty() || *visit.origin != origin_)) {
    return Refusal{kForbidden,
                   "A page of another origin may not connect. Where it shall, name its origin in "
                   "the parameter 'origin' of sinks/live."};
  }
  if (needs_token && !token_.empty() && !has_token(visit)) {
    return Refusal{kUnauthorized,
                   "Send the token of this server: add ?token=... to the address, or send it as "
                   "Authorization: Bearer ..."};
  }
  return std::nullopt;
}

}  // namespace weft::live
