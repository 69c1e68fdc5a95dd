// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>
#include <weft/data/camera.hpp>

#include "access_policy.hpp"
#include "camera/calibrator.hpp"
#include "run_channel.hpp"

namespace weft::live {

/// The limits of the clients.
struct Limits {
  std::size_t clients = 64;               ///< with access
  std::size_t message_bytes = 64 * 1024;  ///< size of a client's message
  /// Connections without access: the head of their request is not complete, they are refused, or
  /// they get a file that needs no token. Beyond this number the oldest one is closed.
  std::size_t guests = 64;
  std::chrono::milliseconds head{2'000};      ///< until the head of a request is complete
  std::chrono::milliseconds request{10'000};  ///< until its answer is through
  std::chrono::milliseconds still{3'000};     ///< without a frame, until clients are notified
  std::chrono::milliseconds write{20'000};    ///< until a client has taken what it is sent
  std::chrono::milliseconds silence{30'000};  ///< until a client answers whether it is there
  std::chrono::milliseconds end{400};         ///< for all clients together, after the last frame
};

/// The data that do not change in a run.
struct LiveSetup {
  AccessPolicy policy;
  PictureStyle style{};
  Camera camera{};
  std::vector<std::int32_t> faces{};  ///< [F,3] vertex indices
  std::string scene{};                ///< members of hello, see messages.hpp
  Limits limits{};
  Calibrator* calibrator = nullptr;  ///< outlives the server; null in tests of other things
};

/// One connection. Everything of it belongs to the server's thread.
class Client {
 public:
  virtual ~Client() = default;
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// The hub has something new.
  virtual void look() {}
  virtual void take_line(const Text& /*line*/) {}
  virtual void take_answer(const ClientAnswer& /*answer*/) {}
  /// The run is over: the client gets what is left, or, `at_once`, nothing any more.
  virtual void end(bool at_once) = 0;
  /// False for a guest.
  virtual bool has_access() const { return true; }

 protected:
  Client() = default;
};

/// The data that the clients share, on the server's thread.
struct Hub {
  Hub(LiveSetup given, RunChannel& run) : setup(std::move(given)), run_channel(run) {}
  Hub(const Hub&) = delete;
  Hub& operator=(const Hub&) = delete;

  bool is_full() const {
    const auto members = std::count_if(clients.begin(), clients.end(),
                                       [](const Client* each) { return each->has_access(); });
    return static_cast<std::size_t>(members) >= setup.limits.clients;
  }
  void drop_oldest_guest() {
    if (!guests.empty()) guests.front()->end(true);
  }

  /// True if a newest frame exists whose count differs from `had`.
  bool has_newer(std::uint64_t had) const { return newest != nullptr && frame_count != had; }

  const LiveSetup setup;
  RunChannel& run_channel;
  std::shared_ptr<ShownFrame> newest;  ///< null before the first one, and when it has passed
  std::uint64_t frame_count = 0;       ///< counts up with each newest frame
  std::string settings;                ///< one JSON object; empty before the first ones
  std::string started_with;            ///< the first ones of the run
  std::uint64_t settings_count = 0;
  bool is_paused = false;
  bool has_left = false;          ///< the run goes on since the client that paused it has left
  std::uint64_t pause_frame = 0;  ///< from which that holds
  std::uint64_t pause_count = 0;
  std::string calibration;  ///< members of its message; empty before the first one
  std::uint64_t calibration_count = 0;
  bool is_still = false;  ///< no frame has come for Limits::still
  std::uint64_t still_count = 0;
  std::set<Client*> clients;  ///< all connections, guests included
  std::list<Client*> guests;  ///< in the order of arrival
  ClientId last_client = 0;
  std::function<void()> when_empty;  ///< called when the last client has gone; may be null
};

/// A client's place among the others, while it lives.
class Place {
 public:
  Place(Hub& hub, Client& client) : hub_(hub), client_(client) { hub.clients.insert(&client); }
  ~Place() {
    hub_.clients.erase(&client_);
    if (hub_.clients.empty() && hub_.when_empty) hub_.when_empty();
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

 private:
  Hub& hub_;
  Client& client_;
};

}  // namespace weft::live
