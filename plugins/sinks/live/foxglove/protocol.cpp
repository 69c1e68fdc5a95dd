// SPDX-License-Identifier: Apache-2.0
// https://github.com/foxglove/ws-protocol, docs/spec.md, of servers without further capabilities.
#include "protocol.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <nlohmann/json.hpp>

#include "foxglove/channels.hpp"

namespace weft::live {
namespace {

using foxglove::Channel;
using foxglove::channels;
using nlohmann::json;

struct Subscription {
  std::uint32_t id;
  std::size_t channel;          ///< position
  std::uint64_t frame_had = 0;  ///< value of Hub::frame_count
};

class FoxgloveProtocol final : public Protocol {
 public:
  explicit FoxgloveProtocol(Hub& hub) : hub_(hub) {
    say(foxglove::server_info());
    say(foxglove::advertisement());
  }

  std::optional<Outgoing> next() override {
    if (!said_.empty()) {
      Outgoing message = text_message(std::move(said_.front()));
      said_.pop_front();
      return message;
    }
    // From the one behind the last on, so that a slow client gets some of each.
    for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
      turn_ = (turn_ + 1) % subscriptions_.size();
      if (auto message = data_for(subscriptions_[turn_])) return message;
    }
    return std::nullopt;
  }

  std::string receive(std::string_view message, bool is_text) override {
    if (!is_text) {
      warn("This server takes no data from clients.");
      return {};
    }
    const json said = json::parse(message, nullptr, false);
    if (!said.is_object()) return "a message that is no JSON object";
    const auto op = said.find("op");
    if (op == said.end() || !op->is_string()) return "a message without an op";
    if (*op == "subscribe") {
      for (const json& each : list_in(said, "subscriptions")) subscribe(each);
    } else if (*op == "unsubscribe") {
      for (const json& id : list_in(said, "subscriptionIds")) unsubscribe(id);
    } else {
      warn("This server cannot do that: it has no further capabilities.");
    }
    return {};
  }

  bool takes_more() const override { return said_.size() < kMostSaid; }

  bool is_served() const override {
    return std::all_of(subscriptions_.begin(), subscriptions_.end(),
                       [&](const Subscription& each) { return !hub_.has_newer(each.frame_had); });
  }

 private:
  static constexpr std::size_t kMostSaid = 64, kMostSubscriptions = 64;

  std::optional<Outgoing> data_for(Subscription& subscription) {
    if (!hub_.has_newer(subscription.frame_had)) return std::nullopt;
    subscription.frame_had = hub_.frame_count;
    const Channel& channel = channels()[subscription.channel];
    const auto make = [&](ShownFrame& frame) { return channel.message(frame, hub_.setup); };
    Text text = hub_.newest->once(channel.topic, make);
    if (text->empty()) return std::nullopt;
    return Outgoing{foxglove::data_head(subscription.id, hub_.newest->copy().taken_ns),
                    std::move(text), false};
  }

  static const json& list_in(const json& said, const char* name) {
    static const json kNone = json::array();
    const auto found = said.find(name);
    return found != said.end() && found->is_array() ? *found : kNone;
  }

  /// A number from 0 to that of 32 bits; nothing where it is none.
  static std::optional<std::uint32_t> number_in(const json& value) {
    if (!value.is_number_unsigned()) return std::nullopt;
    const auto number = value.get<std::uint64_t>();
    if (number > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
    return static_cast<std::uint32_t>(number);
  }

  std::vector<Subscription>::iterator find(std::uint32_t id) {
    return std::find_if(subscriptions_.begin(), subscriptions_.end(),
                        [&](const Subscription& each) { return each.id == id; });
  }

  void subscribe(const json& wanted) {
    if (!wanted.is_object() || !wanted.contains("id") || !wanted.contains("channelId")) {
      return warn("A subscription needs an id and a channelId.");
    }
    const auto id = number_in(wanted["id"]), channel = number_in(wanted["channelId"]);
    if (!id || !channel || *channel == 0 || *channel > channels().size()) {
      return warn("There is no such channel.");
    }
    if (find(*id) != subscriptions_.end()) return warn("This id has a subscription already.");
    if (subscriptions_.size() == kMostSubscriptions) return warn("There are 64 subscriptions.");
    subscriptions_.push_back({*id, *channel - 1, 0});
  }

  void unsubscribe(const json& wanted) {
    const auto id = number_in(wanted);
    const auto found = id ? find(*id) : subscriptions_.end();
    if (found == subscriptions_.end()) return warn("There is no such subscription.");
    subscriptions_.erase(found);
    turn_ = 0;
  }

  void warn(const std::string& message) {
    if (takes_more()) say(foxglove::status(1, message));
  }
  void say(std::string message) { said_.push_back(std::move(message)); }

  Hub& hub_;
  std::deque<std::string> said_;
  std::vector<Subscription> subscriptions_;
  std::size_t turn_ = 0;
};

}  // namespace

std::unique_ptr<Protocol> speak_foxglove(Hub& hub) {
  return std::make_unique<FoxgloveProtocol>(hub);
}

}  // namespace weft::live
