// SPDX-License-Identifier: Apache-2.0
#include "host/workers/worker.hpp"

#include <weft/abi.h>

#include <algorithm>
#include <system_error>

#include "host/workers/codec.hpp"

namespace weft::host {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kQuickStart{20};  ///< no spare is needed for a start like this

}  // namespace

Worker::Worker(Isolation isolation, WorkerContext context, CreateMessage component)
    : isolation_(std::move(isolation)),
      context_(std::move(context)),
      component_(std::move(component)) {}

Worker::~Worker() { end_spare(); }

Result<void> Worker::start() {
  const auto before = Clock::now();
  auto made = make_session({}, nullptr);
  if (!made) return made.error();
  session_ = *std::move(made);
  making_ = Clock::now() - before;
  return {};
}

/// A session whose component gets all messages that the previous one received. May be called by
/// another thread than that of the calls.
Worker::Made Worker::make_session(const std::vector<CreateMessage>& learned,
                                  const std::atomic<bool>* unwanted) {
  auto session = std::make_unique<WorkerSession>(context_, component_.recipe.id, unwanted);
  auto done = session->start(isolation_.program);
  if (done) done = session->create(component_, isolation_.deadline);
  if (done && !prepared_.empty()) done = session->prepare(component_.handle, prepared_);
  for (const CreateMessage& other : learned) {
    if (done) done = session->learn(other, prepared_, isolation_.deadline);
  }
  if (done && beginning_) done = begin(*session);
  if (!done) return done.error();
  return session;
}

Result<void> Worker::begin(WorkerSession& session) const {
  const auto reply = session.converse(MessageKind::process, pack(*beginning_), isolation_.deadline);
  if (!reply) return reply.error();
  if (reply->status != WEFT_OK) return error_in(*reply);
  for (const PlacedRecord& output : reply->outputs) {  // known already: given back at once
    if (auto record = session.adopt(output); !record) return record.error();
  }
  return {};
}

Result<void> Worker::ready() {
  if (session_ != nullptr) return {};
  if (!isolation_.starts_again) {
    return Error{Errc::plugin_failure,
                 "its worker is gone and is not started again, lest it write over what it has "
                 "written",
                 component_.recipe.id};
  }
  const bool is_spare = spare_.valid();
  Made made = is_spare ? spare_.get() : make_session(learned_, nullptr);
  // A spare that was ready for long may have died since, or its failure may be outdated.
  const bool is_stale = made ? (*made)->is_gone() : isolation_.keeps_spare;
  if (is_spare && is_stale) made = make_session(learned_, nullptr);
  if (!made) return made.error();  // the next call tries again
  session_ = *std::move(made);
  session_->take();
  return {};
}

/// Prepares the next session at once, so that the next call waits as briefly as possible.
void Worker::note_death(const Error& death) {
  if (session_ == nullptr || !session_->is_lost()) return;
  session_.reset();
  if (death.code != Errc::cancelled && isolation_.starts_again) make_spare();
}

/// Excess output is discarded, so that it takes no memory, and its author is informed.
void Worker::bound_output(std::uint64_t frame) {
  const std::uint64_t bytes = session_->forget_old_output();
  if (bytes == 0 || !context_.log) return;
  context_.log(component_.stage, kWarning,
               "printed more than " + std::to_string(bytes >> 20U) +
                   " MiB, which its worker does not keep; print less, or into a file",
               frame);
}

void Worker::make_spare() {
  if (spare_.valid()) return;
  try {
    spare_ = std::async(std::launch::async,
                        [this, learned = learned_] { return make_session(learned, &ending_); });
  } catch (const std::system_error&) {
    return;  // there is no thread: the next call makes the process
  }
}

void Worker::end_spare() {
  ending_ = true;
  if (spare_.valid()) spare_.wait();
  spare_ = {};
  ending_ = false;
}

Result<void> Worker::prepare(InputsBySlot inputs) {
  end_spare();  // it was made with others
  prepared_ = std::move(inputs);
  const auto before = Clock::now();
  const bool running = session_ != nullptr;
  auto up = ready();
  if (up && running) {
    up = session_->prepare(component_.handle, prepared_);
    if (session_->is_lost()) session_.reset();
  }
  making_ += Clock::now() - before;
  return up;
}

Result<void> Worker::learn(const CreateMessage& component) {
  if (auto up = ready(); !up) return up;
  if (session_->knows(component.handle)) return {};
  auto known = session_->learn(component, prepared_, isolation_.deadline);
  if (!known) {
    note_death(known.error());
    return known;
  }
  const bool is_new =
      std::none_of(learned_.begin(), learned_.end(),
                   [&](const CreateMessage& other) { return other.handle == component.handle; });
  if (is_new) learned_.push_back(component);
  return known;
}

void Worker::begin_with(int method, std::uint64_t frame) {
  beginning_ = CallMessage{component_.handle, frame, 0, method, {}, {}};
}

Result<Worker::Answer> Worker::process(int method, std::uint64_t frame, std::uint64_t draw,
                                       std::span<const weft_record> inputs,
                                       std::chrono::steady_clock::time_point deadline) {
  if (auto up = ready(); !up) return up.error();
  bound_output(frame);
  std::vector<std::shared_ptr<void>> keep;
  auto placed = session_->place(inputs, keep);
  if (!placed) return placed.error();
  const CallMessage call{component_.handle,
                         frame,
                         draw,
                         method,
                         *std::move(placed),
                         session_->returned(),
                         std::chrono::nanoseconds(deadline.time_since_epoch()).count()};
  const auto reply = session_->converse(MessageKind::process, pack(call), isolation_.deadline);
  if (!reply) {
    note_death(reply.error());
    return reply.error();
  }
  Answer answer{reply->status,  error_in(*reply),        {},
                reply->timings, reply->downloaded_bytes, reply->processor_ms};
  for (const PlacedRecord& output : reply->outputs) {
    auto record = session_->adopt(output);
    if (!record) {
      note_death(record.error());
      return record.error();
    }
    answer.outputs.emplace_back(output.slot, *std::move(record));
  }
  // Not before the component has shown that it works.
  if (isolation_.keeps_spare && making_ > kQuickStart) make_spare();
  return answer;
}

}  // namespace weft::host
