// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>
#include <weft/sdk/sink.hpp>

#include "gate.hpp"
#include "script.hpp"

namespace scripted {

/// A line for each frame; the file bears its name once the run is over.
class LineSink final : public weft::Sink {
 public:
  static constexpr weft::About kAbout{.reads = "shape correspondences"};

  explicit LineSink(weft::Params& p) : script_(p), gate_(p) {
    p.output_path("path", path_, "of the file, none without it");
    p.read("refuse_open", refuse_open_, "fail in open");
    p.read("refuse_finish", refuse_finish_, "fail in finish");
  }

  weft::Result<void> open(const weft::Call& call) override {
    if (auto cancelled = gate_.pass(call)) return *cancelled;
    if (!path_.empty()) stream_.open(path_ + ".part");
    if (!refuse_open_) return {};
    return weft::Error{weft::Errc::io, "cannot open as scripted", ""};
  }

  weft::Result<void> write(const weft::SinkInput& in) override {
    if (auto cancelled = gate_.pass(in.call)) return *cancelled;
    if (auto failure = script_.failure(in.call)) return *failure;
    stream_ << in.call.frame() << ' '
            << (in.shape ? weft::to_string(in.shape->shape_state()) : "no shape") << ' '
            << (in.correspondences ? in.correspondences->count() : -1) << std::endl;
    return {};
  }

  weft::Result<void> finish(const weft::Call& call) override {
    if (auto cancelled = gate_.pass(call)) return *cancelled;
    stream_.close();
    if (!path_.empty()) std::filesystem::rename(path_ + ".part", path_);
    if (!refuse_finish_) return {};
    return weft::Error{weft::Errc::plugin_failure, "cannot finish as scripted", ""};
  }

 private:
  Script script_;
  Gate gate_;
  std::string path_;
  bool refuse_open_ = false;
  bool refuse_finish_ = false;
  std::ofstream stream_;
};

/// Requests changes by script, and writes the outcome of each. While a change request is pending,
/// frames are slow, so that the run still continues when it is granted on a busy machine.
class SteeringSink final : public weft::Sink {
 public:
  static constexpr weft::About kAbout{.reads = "other_shape frame_report run_settings"};

  explicit SteeringSink(weft::Params& p) {
    p.labels("wishes", requests_, "frames written before, and a letter; the wish");
    p.output_path("path", path_, "lines: answers, and what each frame is told");
  }

  weft::Result<void> open(const weft::Call&) override {
    lines_.open(path_);
    return {};
  }

  weft::Result<void> write(const weft::SinkInput& in) override {
    if (waits()) std::this_thread::sleep_for(std::chrono::milliseconds(30));
    const std::lock_guard lock(mutex_);
    ++written_;
    if (in.run_settings) settings_ = in.run_settings->revision;
    lines_ << "frame " << in.call.frame() << " settings " << settings_ << ' '
           << (in.frame_report ? in.frame_report->json : "no report") << std::endl;
    return {};
  }

  weft::Result<void> finish(const weft::Call&) override { return {}; }

  /// One at a time, so that a pause is heard before what ends it.
  std::vector<weft::ChangeRequest> take_change_requests() {
    const std::lock_guard lock(mutex_);
    if (asked_ == requests_.size() || std::stoull(requests_[asked_].first) > written_) return {};
    const auto number = static_cast<std::uint64_t>(asked_);
    return {{number, requests_[asked_++].second}};
  }

  void answer(const weft::ChangeAnswer& answer) {
    const std::lock_guard lock(mutex_);
    ++answered_;
    lines_ << "answer " << answer.number << " frame " << answer.frame << ' ' << answer.refusal
           << std::endl;
  }

 private:
  bool waits() {
    const std::lock_guard lock(mutex_);
    return answered_ < asked_;
  }

  std::vector<std::pair<std::string, std::string>> requests_;
  std::string path_;
  std::ofstream lines_;
  std::mutex mutex_;
  std::uint64_t settings_ = 0;
  std::size_t written_ = 0, asked_ = 0, answered_ = 0;
};

/// Cannot do without visibility.
class VisibilitySink final : public weft::Sink {
 public:
  static constexpr weft::About kAbout{.needs = "visibility"};

  explicit VisibilitySink(weft::Params&) {}

  weft::Result<void> open(const weft::Call&) override { return {}; }
  weft::Result<void> write(const weft::SinkInput&) override { return {}; }
  weft::Result<void> finish(const weft::Call&) override { return {}; }
};

}  // namespace scripted
