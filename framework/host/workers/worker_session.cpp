// SPDX-License-Identifier: Apache-2.0
#include "host/workers/worker_session.hpp"

#include <algorithm>
#include <mutex>
#include <optional>
#include <weft/core/quote.hpp>
#include <weft/core/version.hpp>

#include "host/workers/codec.hpp"

namespace weft::host {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kCancelPatience{1000};
constexpr std::chrono::milliseconds kLeastToStart{10'000};

/// The log messages of one call. The worker limits them too, unless a library has damaged it.
class LogMessages {
 public:
  explicit LogMessages(const WorkerContext& context) : context_(context) {}
  ~LogMessages() {
    if (count_ <= kMost) return;
    context_.log(component_, kWarning,
                 std::to_string(count_ - kMost) + " further messages were dropped", frame_);
  }
  LogMessages(const LogMessages&) = delete;
  LogMessages& operator=(const LogMessages&) = delete;

  void pass_on(const LogMessage& message) {
    if (++count_ > kMost) return;
    component_ = escaped(message.component, kLongestName);
    frame_ = message.frame;
    context_.log(component_, std::clamp(message.level, 0, kWarning),
                 escaped(message.text, kLongestText), frame_);
  }

 private:
  // More than the worker lets one component send: components that are nested in it add theirs.
  static constexpr std::uint64_t kMost = 1000;
  static constexpr std::size_t kLongestName = 1000, kLongestText = 5000;  ///< [characters]

  const WorkerContext& context_;
  std::uint64_t count_ = 0;
  std::string component_;
  std::uint64_t frame_ = 0;
};

}  // namespace

/// Content that a worker sends is untrusted.
Error error_in(const ReplyMessage& reply) {
  constexpr std::size_t kLongestText = 1023;
  const bool known = reply.code >= static_cast<std::int32_t>(Errc::no_result) &&
                     reply.code <= static_cast<std::int32_t>(Errc::end);
  return {known ? static_cast<Errc>(reply.code) : Errc::plugin_failure,
          reply.message.substr(0, kLongestText), reply.where.substr(0, kLongestText),
          reply.subject.substr(0, kLongestText)};
}

/// Memory that a worker has lent to this process, until the process releases it.
class Loans : public std::enable_shared_from_this<Loans> {
 public:
  Loans(std::shared_ptr<SharedMemory> memory, std::shared_ptr<SharedInputs> inputs)
      : memory_(std::move(memory)), inputs_(std::move(inputs)) {}

  const SharedMemory& memory() const { return *memory_; }

  /// The memory at an offset, which is given back with the last reference; null when the worker
  /// has no such memory.
  std::shared_ptr<void> take(std::uint64_t offset, std::int64_t bytes) {
    void* memory = memory_->at(offset, static_cast<std::uint64_t>(bytes));
    if (memory == nullptr || offset % 64 != 0) return nullptr;
    inputs_->watch(memory);
    return {memory, [loans = shared_from_this(), offset](void* p) {
              loans->inputs_->forget(p);
              const std::lock_guard lock(loans->mutex_);
              loans->returned_.push_back(offset);
            }};
  }

  std::vector<std::uint64_t> returned() {
    const std::lock_guard lock(mutex_);
    return std::exchange(returned_, {});
  }

 private:
  std::shared_ptr<SharedMemory> memory_;
  std::shared_ptr<SharedInputs> inputs_;
  std::mutex mutex_;
  std::vector<std::uint64_t> returned_;  ///< offsets
};

WorkerSession::WorkerSession(const WorkerContext& context, std::string id,
                             const std::atomic<bool>* unwanted)
    : context_(context), id_(std::move(id)), unwanted_(unwanted) {}

WorkerSession::~WorkerSession() = default;

Result<void> WorkerSession::start(const std::string& program) {
  auto outputs = SharedMemory::create(SharedMemory::Access::read);
  if (!outputs) return outputs.error();
  const SharedArena& arena = *context_.inputs->arena();
  auto process = WorkerProcess::start(program, arena.memory().file(), (*outputs)->file());
  if (!process) return process.error();
  process_ = *std::move(process);
  loans_ = std::make_shared<Loans>(*outputs, context_.inputs);
  const HelloMessage hello{kVersion,
                           context_.run_seed,
                           arena.memory().reserve_bytes(),
                           loans_->memory().reserve_bytes(),
                           *arena.memory().offset_of(context_.cancel.get()),
                           context_.threads};
  const auto met = converse(MessageKind::hello, pack(hello));
  if (!met) return met.error();
  if (met->status == WEFT_OK) return {};
  return Error{Errc::incompatible, error_in(*met).message, id_};
}

Result<void> WorkerSession::create(const CreateMessage& component,
                                   std::chrono::milliseconds deadline) {
  // If the user limits the time of a call, the start is limited too, because loading a library may
  // hang.
  const auto patience = deadline.count() == 0 ? deadline : std::max(deadline, kLeastToStart);
  const auto reply = converse(MessageKind::create, pack(component), patience);
  if (!reply) return reply.error();
  if (reply->status != WEFT_OK) return error_in(*reply);
  known_.insert(component.handle);
  return {};
}

Result<void> WorkerSession::prepare(std::uint64_t handle, const InputsBySlot& inputs) {
  std::vector<weft_record> views;
  for (const auto& [slot, record] : inputs) views.push_back(record->view(slot.c_str()));
  auto placed = place(views, kept_);
  if (!placed) return placed.error();
  const auto reply =
      converse(MessageKind::prepare, pack(CallMessage{handle, 0, 0, 0, *std::move(placed), {}}));
  if (!reply) return reply.error();
  return reply->status == WEFT_OK ? Result<void>{} : error_in(*reply);
}

Result<void> WorkerSession::learn(const CreateMessage& component, const InputsBySlot& inputs,
                                  std::chrono::milliseconds deadline) {
  if (auto made = create(component, deadline); !made) return made;
  auto prepared = prepare(component.handle, inputs);
  if (!prepared) known_.erase(component.handle);
  return prepared;
}

Result<std::vector<PlacedRecord>> WorkerSession::place(
    std::span<const weft_record> records, std::vector<std::shared_ptr<void>>& keep) const {
  std::vector<PlacedRecord> result;
  for (const weft_record& record : records) {
    auto placed = context_.inputs->place(record, keep);
    if (!placed) return placed.error();
    result.push_back(*std::move(placed));
  }
  return result;
}

Result<std::shared_ptr<Record>> WorkerSession::adopt(const PlacedRecord& placed) {
  auto record = Record::make(placed.type);
  for (const PlacedArray& array : placed.arrays) {
    const std::int64_t bytes = array_bytes(array.dtype, array.ndim, array.shape.data());
    std::shared_ptr<void> memory = bytes >= 0 ? loans_->take(array.offset, bytes) : nullptr;
    if (memory == nullptr || !record->adopt(array.name, array.dtype, array.ndim, array.shape.data(),
                                            std::move(memory))) {
      return fail("named an array that it does not have, and was ended");
    }
  }
  return record;
}

std::vector<std::uint64_t> WorkerSession::returned() { return loans_->returned(); }

Result<ReplyMessage> WorkerSession::converse(MessageKind kind, const std::string& content,
                                             std::chrono::milliseconds deadline) {
  const auto start = Clock::now();
  std::optional<Clock::time_point> cancelled_at;
  bool has_ended = false;
  if (is_taken()) context_.cancel->store(context_.cancelled());
  const auto keep_waiting = [&] {
    const auto now = Clock::now();
    if (!cancelled_at && context_.cancelled()) cancelled_at = now;
    if (is_taken()) {
      context_.cancel->store(cancelled_at.has_value());
      if (cancelled_at && now - *cancelled_at > kCancelPatience) return false;
    } else if (*unwanted_ || cancelled_at) {
      return false;
    }
    if (deadline.count() != 0 && now - start >= deadline) return false;
    // Messages that it sent before its end are read first.
    return !std::exchange(has_ended, process_->is_gone());
  };
  const auto gave_up = [&] {
    if (cancelled_at) {
      return fail("did not stop when cancelled, and was ended", Errc::cancelled);
    }
    if (has_ended) return died();
    return fail("gave no answer within " + std::to_string(deadline.count()) + " ms and was ended");
  };
  LogMessages log_messages(context_);
  Channel& channel = process_->channel();
  const std::uint64_t call = ++calls_;
  if (!channel.send(kind, content, call)) return died();
  for (Message message;; message = {}) {
    const auto got = channel.receive(message, keep_waiting);
    if (got == Channel::Received::closed) return died();
    if (got == Channel::Received::unreadable) {
      return fail("sent what is no message, and was ended");
    }
    if (got == Channel::Received::gave_up) return gave_up();
    // A second answer, of a copy of the process, comes late and is not that of this call.
    if (message.call < call && keep_waiting()) continue;
    if (message.call < call) return gave_up();
    if (message.kind == MessageKind::reply && message.call == call) {
      if (auto reply = unpack<ReplyMessage>(message.content)) return *std::move(reply);
    }
    const auto log = unpack<LogMessage>(message.content);
    if (message.kind != MessageKind::log || !log) {
      return fail("sent what is no answer, and was ended");
    }
    if (context_.log && is_taken()) log_messages.pass_on(*log);
    if (!keep_waiting()) return gave_up();
  }
}

Error WorkerSession::died() {
  const Error death = process_->cause_of_death();
  return fail(death.message, death.code);
}

Error WorkerSession::fail(const std::string& cause, Errc code) {
  process_->kill();
  process_.reset();
  return {code, "its worker " + cause, id_};
}

}  // namespace weft::host
