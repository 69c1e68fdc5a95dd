// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>
#include <weft/sdk/sink.hpp>

#include "frame.hpp"

namespace weft::live {

using ClientId = std::uint64_t;
/// Stands for the server itself, which resumes a run whose pausing clients have all left.
constexpr ClientId kServer = 0;

/// The result of a client's change request, under the client's own number.
struct ClientAnswer {
  ClientId client;
  std::uint64_t number, frame;
  std::string refusal;
  std::optional<bool> pauses{};  ///< true if the run then pauses; set if a pause was requested
};

/// The messages that have come from the run since the server last looked.
struct Arrivals {
  bool is_passed = false;          ///< the previous newest frame is outdated
  std::optional<FrameCopy> frame;  ///< the newest
  std::deque<std::string> lines;   ///< reports, the newest ones
  std::optional<std::string> settings;
  std::optional<std::string> calibration;  ///< its newest state
  std::vector<ClientAnswer> answers;
};

/// The exchange between the run and the server, each on separate threads. Its memory is bounded: it
/// keeps the newest frame, and of all other messages as many as a reader needs to miss none.
class RunChannel {
 public:
  // From the run.
  int viewers() const { return viewers_; }
  bool is_watched() const { return viewers_ > 0; }  ///< true if frames are worth copying
  bool is_read() const { return readers_ > 0; }     ///< and lines
  void put_frame(FrameCopy frame);
  /// A frame without viewers: later viewers are not shown the one before it.
  void pass_frame();
  void put_line(std::string line);
  void put_settings(std::string settings);
  void put_calibration(std::string state);
  std::vector<ChangeRequest> take_change_requests();
  void answer(const ChangeAnswer& answer);

  // From the server. `wake` is called, from any thread, when there is something to take.
  void attach(std::function<void()> wake);
  void detach();
  Arrivals take();
  /// Why the change request is not handed on; empty where it is.
  std::string ask(ClientId client, std::uint64_t number, std::string text);
  /// The client is gone. A pause ends with the last client that requested it.
  void leave(ClientId client) noexcept;
  void count_viewers(int change) { viewers_ += change; }
  void count_readers(int change) { readers_ += change; }

 private:
  struct Asker {
    ClientId client;
    std::uint64_t number;
    std::optional<bool> pauses;
  };

  void wake();
  void add_request(ClientId client, std::uint64_t number, std::string text);

  std::atomic<int> viewers_ = 0, readers_ = 0;
  std::mutex mutex_;
  std::function<void()> wake_;
  bool is_woken_ = false, is_shown_ = false;
  Arrivals arrivals_;
  std::deque<ChangeRequest> requests_;
  std::set<ClientId> pausing_;             ///< those whose pause holds, or is about to
  bool is_abandoned_ = false;              ///< all of them have left
  std::map<std::uint64_t, Asker> askers_;  ///< by our own number
  std::uint64_t asked_ = 0;
};

}  // namespace weft::live
