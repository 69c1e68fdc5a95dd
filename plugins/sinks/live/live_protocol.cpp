// SPDX-License-Identifier: Apache-2.0
#include <deque>

#include "messages.hpp"
#include "protocol.hpp"

namespace weft::live {
namespace {

class LiveProtocol final : public Protocol {
 public:
  LiveProtocol(Hub& hub, ClientId client) : hub_(hub), client_(client) {}

  std::optional<Outgoing> next() override {
    if (!is_greeted_) {
      is_greeted_ = true;
      settings_had_ = hub_.settings_count;
      return text_message(hello_message(hub_.setup.scene, hub_.settings, hub_.started_with));
    }
    if (!answers_.empty()) {
      Outgoing answer = text_message(std::move(answers_.front()));
      answers_.pop_front();
      return answer;
    }
    if (settings_had_ != hub_.settings_count) {
      settings_had_ = hub_.settings_count;
      return text_message(settings_message(hub_.settings));
    }
    if (calibration_had_ != hub_.calibration_count) {
      calibration_had_ = hub_.calibration_count;
      return text_message(calibration_message(hub_.calibration));
    }
    if (pause_had_ != hub_.pause_count) {
      pause_had_ = hub_.pause_count;
      return text_message(pause_message(hub_.is_paused, hub_.pause_frame, hub_.has_left));
    }
    if (still_had_ != hub_.still_count) {
      still_had_ = hub_.still_count;
      return text_message(still_message(hub_.is_still));
    }
    if (!is_ready_ || is_served()) return std::nullopt;
    is_ready_ = false;
    frame_had_ = hub_.frame_count;
    const auto message = [](ShownFrame& frame) {
      return frame_message(frame.copy(), frame.jpeg());
    };
    return Outgoing{{}, hub_.newest->once(kLiveProtocol, message), false};
  }

  std::string receive(std::string_view message, bool is_text) override {
    if (!is_text) return "a message that is no text";
    const auto said = parse_said(message);
    if (!said) return said.error().message;
    if (!said->is_change_request) {
      is_ready_ = true;
      return {};
    }
    constexpr std::string_view kCalibrate = "calibrate ";
    if (said->text.starts_with(kCalibrate) && hub_.setup.calibrator != nullptr) {
      const std::string_view request = std::string_view(said->text).substr(kCalibrate.size());
      answers_.push_back(answer_message(said->number, 0, hub_.setup.calibrator->ask(request)));
      return {};
    }
    const std::string refusal = hub_.run_channel.ask(client_, said->number, said->text);
    if (!refusal.empty()) answers_.push_back(answer_message(said->number, 0, refusal));
    return {};
  }

  void take_answer(const ClientAnswer& answer) override {
    answers_.push_back(answer_message(answer.number, answer.frame, answer.refusal));
  }

  bool takes_more() const override { return answers_.size() < kMostAnswers; }
  bool is_served() const override { return !hub_.has_newer(frame_had_); }

 private:
  static constexpr std::size_t kMostAnswers = 64;

  Hub& hub_;
  ClientId client_;
  bool is_greeted_ = false, is_ready_ = false;
  std::uint64_t calibration_had_ = 0, settings_had_ = 0, pause_had_ = 0, still_had_ = 0,
                frame_had_ = 0;
  std::deque<std::string> answers_;
};

}  // namespace

std::unique_ptr<Protocol> speak_live(Hub& hub, ClientId client) {
  return std::make_unique<LiveProtocol>(hub, client);
}

}  // namespace weft::live
