// SPDX-License-Identifier: Apache-2.0
#include "pipeline/steering/steering.hpp"

#include <chrono>
#include <nlohmann/json.hpp>
#include <weft/core/quote.hpp>

#include "pipeline/steering/settings_file.hpp"

namespace weft {
namespace {

/// The client that requested the change may have disconnected, which is no error of the run.
void tell(const host::Instance& sink, const ChangeAnswer& answer) {
  static_cast<void>(host::ExecutionContext::answer(sink, answer));
}

}  // namespace

Steering::Steering(ChangeMaker maker, Executor& executor, std::vector<const host::Instance*> sinks,
                   ChangesByFrame repeated, std::string folder, bool restarts)
    : maker_(std::move(maker)),
      executor_(executor),
      sinks_(std::move(sinks)),
      repeated_(std::move(repeated)),
      folder_(std::move(folder)),
      restarts_(restarts),
      thread_([this] { make_all(); }) {}

Steering::~Steering() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_all();
  thread_.join();
  for (const Made& made : made_) maker_.discard(made.change);
}

bool Steering::wait_for_turn(const std::function<bool()>& cancelled) {
  constexpr std::chrono::milliseconds kAskEvery{10};  // change requests do not wake a run, so that
                                                      // it polls
  for (take_change_requests(); pace_ == Pace::pausing && !cancelled(); take_change_requests()) {
    std::this_thread::sleep_for(kAskEvery);
  }
  if (pace_ == Pace::stepping) pace_ = Pace::pausing;
  return pace_ != Pace::ended && !cancelled();
}

void Steering::take_change_requests() {
  for (const host::Instance* sink : sinks_) {
    const auto requests = host::ExecutionContext::take_change_requests(*sink);
    if (!requests) continue;
    for (const ChangeRequest& request : *requests) hear(*sink, request);
  }
  if (restart()) pace_ = Pace::ended;
}

std::optional<std::vector<std::string>> Steering::restart() {
  const std::lock_guard lock(mutex_);
  return restart_;
}

void Steering::hear(const host::Instance& sink, const ChangeRequest& request) {
  constexpr std::string_view kSet = "set ", kRestart = "restart ";
  if (request.text.starts_with(kSet)) {
    return ask({&sink, request.number, request.text.substr(kSet.size())});
  }
  if (request.text == "save") return ask({&sink, request.number, "", Asked::Kind::save});
  if (request.text.starts_with(kRestart) && restarts_) {
    return ask({&sink, request.number, request.text.substr(kRestart.size()), Asked::Kind::restart});
  }
  static constexpr std::pair<std::string_view, Pace> kPaces[] = {{"pause", Pace::pausing},
                                                                 {"step", Pace::stepping},
                                                                 {"resume", Pace::going},
                                                                 {"stop", Pace::ended}};
  for (const auto& [word, pace] : kPaces) {
    if (word != request.text) continue;
    pace_ = pace;
    return tell(sink, {request.number, next_frame_, ""});
  }
  tell(sink, {request.number, 0,
              request.text.starts_with(kRestart)
                  ? "only weft live starts a run again: end this one, and start it with --set"
                  : "no run accepts " + quote(request.text) +
                        "; send set PATH=VALUE, save, pause, step, resume, stop or restart LIST"});
}

void Steering::ask(Asked asked) {
  {
    const std::lock_guard lock(mutex_);
    asked_.push_back(std::move(asked));
  }
  changed_.notify_all();
}

void Steering::make_all() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_over_ || !asked_.empty(); });
    if (is_over_) return;
    Asked asked = std::move(asked_.front());
    asked_.pop_front();
    is_making_ = true;
    lock.unlock();
    if (asked.kind != Asked::Kind::change) {
      asked.kind == Asked::Kind::save ? save(asked) : prepare_restart(asked);
      lock.lock();
      is_making_ = false;
      continue;
    }
    auto change = maker_.make(asked.setting);
    if (!change && asked.sink != nullptr) {
      tell(*asked.sink, {asked.number, 0, change.error().message});
    }
    lock.lock();
    is_making_ = false;
    if (change) {
      made_.push_back({std::move(asked), *std::move(change)});
    } else if (asked.sink == nullptr) {
      failure_ =
          Error{change.error().code,
                "cannot repeat the change " + quote(asked.setting) + ": " + change.error().message,
                change.error().where};
    }
    changed_.notify_all();
  }
}

/// The settings with all changes that were requested before.
void Steering::save(const Asked& asked) const {
  const auto text = maker_.yaml();
  const auto number = text ? save_settings(folder_, *text) : Result<std::uint64_t>(text.error());
  if (number) return tell(*asked.sink, {asked.number, *number, ""});
  tell(*asked.sink, {asked.number, 0, number.error().message});
}

void Steering::prepare_restart(const Asked& asked) {
  std::vector<std::string> more;
  try {
    more = nlohmann::json::parse(asked.setting).get<std::vector<std::string>>();
  } catch (const nlohmann::json::exception&) {
    return tell(*asked.sink, {asked.number, 0,
                              "restart needs a JSON list of texts, such as "
                              "[\"source.device=1\"], not " +
                                  quote(asked.setting)});
  }
  auto settings = maker_.with_changes(more);
  if (!settings) return tell(*asked.sink, {asked.number, 0, settings.error().message});
  tell(*asked.sink, {asked.number, 0, ""});  // the sink is gone when the run has ended
  const std::lock_guard lock(mutex_);
  restart_ = *std::move(settings);
}

/// Waits for the changes of an earlier run up to this frame.
Result<void> Steering::repeat(std::uint64_t frame) {
  if (repeated_.empty() || repeated_.begin()->first > frame) return {};
  for (auto due = repeated_.begin(); due != repeated_.end() && due->first <= frame;
       due = repeated_.erase(due)) {
    for (std::string& setting : due->second) ask({nullptr, 0, std::move(setting)});
  }
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return asked_.empty() && !is_making_; });
  if (failure_) return *failure_;
  return {};
}

Result<std::optional<std::string>> Steering::change(std::uint64_t frame) {
  if (const auto repeated = repeat(frame); !repeated) return repeated.error();
  std::deque<Made> made;
  {
    const std::lock_guard lock(mutex_);
    made.swap(made_);
  }
  std::optional<std::string> settings;
  for (Made& each : made) {
    for (StageChange& stage : each.change.stages) {
      executor_.change(stage.stage, std::move(stage.config), std::move(stage.made));
    }
    settings = std::move(each.change.settings);
    applied_.push_back(std::move(each.asked));
  }
  return settings;
}

void Steering::note(FrameResult& frame) {
  next_frame_ = frame.index + 1;
  for (Asked& asked : applied_) {
    if (asked.sink != nullptr) tell(*asked.sink, {asked.number, frame.index, ""});
    frame.changes.push_back(std::move(asked.setting));
  }
  applied_.clear();
}

}  // namespace weft
