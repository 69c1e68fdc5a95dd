// SPDX-License-Identifier: Apache-2.0
#include "host/serving/server.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <deque>
#include <fstream>
#include <thread>
#include <weft/core/version.hpp>

#include "host/calling/execution_context.hpp"
#include "host/calling/hashing.hpp"
#include "host/guarding/library_call.hpp"
#include "host/workers/channel.hpp"
#include "host/workers/codec.hpp"

namespace weft::host {
namespace {

/// The host holds its end until it dies or has waited for this process.
void end_with_host(int socket) {
  // A duplicate of the descriptor: the other one is closed while this thread still polls.
  std::thread([own = fcntl(socket, F_DUPFD_CLOEXEC, 0)] {
    pollfd hung_up{own, 0, 0};
    while (poll(&hung_up, 1, -1) <= 0) continue;
    _exit(1);
  }).detach();
}

/// Whatever else the host has open is not this process's to hold.
void close_all_but(std::array<int, 3> files) {
  std::sort(files.begin(), files.end());
  int first = STDERR_FILENO + 1;
  for (const int file : files) {
    if (file > first) close_range(static_cast<unsigned>(first), static_cast<unsigned>(file - 1), 0);
    first = file + 1;
  }
  close_range(static_cast<unsigned>(first), ~0U, 0);
}

/// When memory runs short the kernel shall take this process, not its host.
void offer_itself_to_the_kernel() { std::ofstream("/proc/self/oom_score_adj") << 500; }

class Server {
 public:
  Server(Channel& channel, std::shared_ptr<SharedMemory> inputs,
         std::shared_ptr<SharedMemory> outputs, const HelloMessage& hello)
      : channel_(channel),
        inputs_(std::move(inputs)),
        arena_(std::make_shared<SharedArena>(std::move(outputs))),
        context_(
            hello.run_seed, [this](const auto&... said) { log(said...); }, arena_,
            kRevisionOfWorker) {
    const auto* cancel = static_cast<const std::atomic<bool>*>(
        inputs_->at(hello.cancel_offset, sizeof(std::atomic<bool>)));
    context_.cancellation().watch([cancel] { return cancel != nullptr && cancel->load(); });
    context_.divide_threads(hello.threads, 1);
  }

  ReplyMessage answer(const Message& message) {
    call_ = message.call;
    if (message.kind == MessageKind::create) {
      if (const auto create = unpack<CreateMessage>(message.content)) return make(*create);
    }
    if (const auto call = unpack<CallMessage>(message.content)) {
      if (message.kind == MessageKind::prepare) return prepare(*call);
      if (message.kind == MessageKind::process) return process(*call);
    }
    return reply_of({Errc::plugin_failure, "the worker does not understand the host", {}});
  }

 private:
  static ReplyMessage reply_of(const Error& error, std::int32_t status = WEFT_ERROR) {
    return {status,
            static_cast<std::int32_t>(error.code),
            error.message,
            error.where,
            error.subject,
            {},
            {},
            0,
            0.0};
  }

  void log(const std::string& component, int level, const std::string& text, std::uint64_t frame) {
    channel_.send(MessageKind::log, pack(LogMessage{component, text, level, frame}), call_);
  }

  ReplyMessage make(const CreateMessage& create) {
    const ComponentSpec spec = create.recipe.spec(installed_);
    const auto instance = context_.instantiate(spec, create.stage, create.path);
    if (!instance) return reply_of(instance.error());
    instances_[create.handle] = *instance;
    return {};
  }

  ReplyMessage prepare(const CallMessage& call) {
    std::deque<std::vector<weft_array>> arrays;
    const auto ready =
        context_.prepare_here(*instances_.at(call.handle), views(call.inputs, arrays));
    return ready ? ReplyMessage{} : reply_of(ready.error());
  }

  ReplyMessage process(const CallMessage& call) {
    const Stopwatch watch;
    for (const std::uint64_t offset : call.returned) unreturned_.erase(offset);
    std::deque<std::vector<weft_array>> arrays;
    const Outcome outcome = context_.call(*instances_.at(call.handle), call.method,
                                          views(call.inputs, arrays), call.frame, call.draw,
                                          SteadyTime(std::chrono::nanoseconds(call.deadline_ns)));
    ReplyMessage reply = reply_of(outcome.error, outcome.status);
    Timings timings = context_.times().take();
    if (!timings.empty()) timings.pop_back();  // the call itself, which the host measures
    for (const Timing& timing : timings) {
      const std::chrono::nanoseconds start = timing.start.time_since_epoch();
      reply.timings.push_back({timing.component, timing.method, start.count(), timing.took.ms,
                               timing.took.processor_ms, timing.status, timing.downloaded_bytes});
    }
    reply.downloaded_bytes = outcome.downloaded_bytes;
    std::vector<RecordPtr> here;  // devices are this process's
    for (const auto& [slot, record] : outcome.outputs) {
      auto fetched = record->in_host_memory();
      if (!fetched) return reply_of(fetched.error());
      here.push_back(*std::move(fetched));
    }
    for (std::size_t i = 0; i < here.size(); ++i) {
      reply.outputs.push_back(lend(outcome.outputs[i].first, here[i]));
    }
    reply.processor_ms = watch.spent().processor_ms;
    return reply;
  }

  /// The record stays until the host has done with all its arrays.
  PlacedRecord lend(const std::string& slot, const RecordPtr& record) {
    const weft_record view = record->view("");
    PlacedRecord placed{slot, std::string(record->type()), 0, 0, view.frame, {}};
    for (std::uint64_t i = 0; i < view.count; ++i) {
      const weft_array& array = view.arrays[i];
      PlacedArray& target = placed.arrays.emplace_back();
      target.name = array.name;
      target.dtype = array.dtype;
      target.ndim = array.ndim;
      std::copy(std::begin(array.shape), std::end(array.shape), target.shape.begin());
      target.offset = *arena_->memory().offset_of(array.data);
      unreturned_[target.offset] = record;
    }
    return placed;
  }

  /// The records that the host placed, in the form that a call needs.
  std::vector<weft_record> views(const std::vector<PlacedRecord>& placed,
                                 std::deque<std::vector<weft_array>>& arrays) const {
    std::vector<weft_record> records;
    for (const PlacedRecord& record : placed) {
      std::vector<weft_array>& own = arrays.emplace_back();
      for (const PlacedArray& array : record.arrays) {
        weft_array& view = own.emplace_back();
        view.name = array.name.c_str();
        view.dtype = array.dtype;
        view.ndim = array.ndim;
        std::copy(array.shape.begin(), array.shape.end(), view.shape);
        std::copy(array.stride.begin(), array.stride.end(), view.stride);
        view.data = inputs_->at(array.offset, 0);
        view.memory = WEFT_SHARED;
      }
      const auto maker = instances_.find(record.producer);
      const std::uint64_t producer = maker != instances_.end() ? handle_of(*maker->second) : 0;
      records.push_back({record.slot.c_str(),
                         record.type.c_str(),
                         record.revision,
                         producer,
                         own.size(),
                         own.data(),
                         record.frame,
                         0,
                         0,
                         {}});
    }
    return records;
  }

  Channel& channel_;
  std::atomic<std::uint64_t> call_{0};  ///< that is being answered
  std::shared_ptr<SharedMemory> inputs_;
  std::shared_ptr<SharedArena> arena_;
  std::deque<Installed> installed_;  ///< behind the components
  ExecutionContext context_;
  std::map<std::uint64_t, Instance*> instances_;   ///< by their handles in the host
  std::map<std::uint64_t, RecordPtr> unreturned_;  ///< by the offset of each array
};

/// Empty if the host has this version.
std::string stranger(const HelloMessage& hello) {
  if (hello.version == kVersion) return {};
  return std::string("weft-worker has version ") + kVersion +
         ", the program that started it has version " + hello.version + "; install both together";
}

}  // namespace

void serve_host(int socket, int inputs, int outputs) {
  close_all_but({socket, inputs, outputs});
  std::signal(SIGXFSZ, SIG_IGN);  // as in the program: what cannot be written is an error
  // Processes that a library starts must not keep the descriptors open.
  for (const int file : {socket, inputs, outputs}) fcntl(file, F_SETFD, FD_CLOEXEC);
  end_with_host(socket);
  offer_itself_to_the_kernel();
  Channel channel(socket);
  Message message;
  if (channel.receive(message) != Channel::Received::message) return;
  const auto hello = unpack<HelloMessage>(message.content);
  if (!hello) return;
  ReplyMessage met;
  met.message = stranger(*hello);
  auto read = SharedMemory::attach(inputs, SharedMemory::Access::read, hello->inputs_reserve_bytes);
  auto written =
      SharedMemory::attach(outputs, SharedMemory::Access::write, hello->outputs_reserve_bytes);
  if (!read) met.message = read.error().message;
  if (!written) met.message = written.error().message;
  met.status = met.message.empty() ? WEFT_OK : WEFT_ERROR;
  if (!channel.send(MessageKind::reply, pack(met), message.call) || met.status != WEFT_OK) return;
  Server server(channel, *std::move(read), *std::move(written), *hello);
  while (channel.receive(message) == Channel::Received::message) {
    const auto reply = [&] {
      const OneProcess one;
      return pack(server.answer(message));
    }();
    if (!channel.send(MessageKind::reply, reply, message.call)) return;
  }
}

}  // namespace weft::host
