// SPDX-License-Identifier: Apache-2.0
// A worker program whose answers to calls are damaged, each in another way. In frame 1000 it sends
// log messages that a component could not.
#include <cstdlib>
#include <weft/core/rng.hpp>

#include "host/records/shared_memory.hpp"
#include "host/workers/channel.hpp"
#include "host/workers/codec.hpp"

namespace {

using namespace weft::host;

constexpr std::int64_t kMatches = 5;

PlacedArray array(const char* name, std::int32_t dtype, std::uint64_t offset) {
  return {name, dtype, 1, {kMatches}, {}, offset};
}

/// The reply of a correct filter.
ReplyMessage honest() {
  ReplyMessage reply;
  reply.outputs = {{"inlier_mask",
                    "inlier_mask/1",
                    0,
                    0,
                    WEFT_NO_FRAME,
                    {array("kept", WEFT_U8, 0), array("score", WEFT_F64, 64)}}};
  reply.timings = {{"filters/warp", "fit", 0, 1.0, 1.0, WEFT_OK}};
  return reply;
}

/// A few bytes changed, and now and then cut short; every fourth answer is honest.
std::string damaged(std::string bytes, weft::Rng& rng) {
  const auto size = static_cast<std::uint32_t>(bytes.size());
  if (rng.below(4) == 0) return bytes;
  for (std::uint32_t i = 0; i < 1 + rng.below(3); ++i) {
    bytes[rng.below(size)] = static_cast<char>(rng.below(256));
  }
  if (rng.below(8) == 0) bytes.resize(rng.below(size));
  return bytes;
}

void flood(Channel& channel, std::uint64_t call) {
  const std::string text = "\x1b[2J" + std::string(1 << 20, 'x');
  for (int i = 0; i < 1500; ++i) {
    const std::string bytes = pack(LogMessage{"filters\n", i < 4 ? text : "short", 77, 1000});
    channel.send(MessageKind::log, bytes, call);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  Channel channel(std::atoi(argv[1]));
  const auto memory = SharedMemory::attach(std::atoi(argv[3]), SharedMemory::Access::write, 4096);
  if (!memory || !(*memory)->grow_to(4096)) return 1;
  Message message;
  while (channel.receive(message) == Channel::Received::message) {
    std::string bytes = pack(ReplyMessage{});
    if (const auto call = unpack<CallMessage>(message.content);
        call && message.kind == MessageKind::process) {
      weft::Rng rng(call->frame);
      bytes = damaged(pack(honest()), rng);
      if (call->frame == 1000) flood(channel, message.call);
    }
    if (!channel.send(MessageKind::reply, bytes, message.call)) return 1;
  }
  return 0;
}
