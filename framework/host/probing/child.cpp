// SPDX-License-Identifier: Apache-2.0
#include "host/probing/child.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <weft/core/index.hpp>

#include "host/guarding/library_call.hpp"
#include "process/child.hpp"

namespace weft::host {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kLongestAnswer_bytes = 256 << 20;

/// How an answer goes through a pipe: this, then the texts one behind the other.
struct Header {
  std::int32_t code = 0;  ///< code of an Error; 0 for an answer
  std::array<std::uint64_t, 2> sizes{};
};

bool write_all(int pipe, const void* bytes, std::size_t size) {
  const char* next = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = write(pipe, next, size);
    if (written < 0 && errno != EINTR) return false;
    if (written < 0) continue;
    next += written;
    size -= to_index(written);
  }
  return true;
}

void send(int pipe, const Result<std::string>& result) {
  Header header;
  const std::string& text = result ? *result : result.error().message;
  const std::string where = result ? std::string() : result.error().where;
  if (!result) header.code = static_cast<std::int32_t>(result.error().code);
  header.sizes = {text.size(), where.size()};
  if (write_all(pipe, &header, sizeof(header)) && write_all(pipe, text.data(), text.size())) {
    write_all(pipe, where.data(), where.size());
  }
}

/// The answer, once all of it is there.
std::optional<Result<std::string>> read_answer(const std::string& bytes) {
  Header header;
  if (bytes.size() < sizeof(header)) return std::nullopt;
  std::memcpy(&header, bytes.data(), sizeof(header));
  const auto& [text, where] = header.sizes;
  const std::size_t rest = bytes.size() - sizeof(header);
  if (text > rest || where > rest - text) return std::nullopt;
  std::string said = bytes.substr(sizeof(header), text);
  if (header.code == 0) return Result<std::string>(std::move(said));
  return Result<std::string>(Error{static_cast<Errc>(header.code), std::move(said),
                                   bytes.substr(sizeof(header) + text, where)});
}

int answer_in_child(const std::function<Result<std::string>()>& find_out, int pipe) {
  const auto found = [&] {
    const OneProcess one;
    return find_out();
  };
  try {
    send(pipe, found());
  } catch (const std::exception& thrown) {
    send(pipe, Error{Errc::plugin_failure, std::string("throws: ") + thrown.what()});
  } catch (...) {
    send(pipe, Error{Errc::plugin_failure, "throws what is no std::exception"});
  }
  return 0;
}

std::string how_it_ended(const process::Ending& ending) {
  if (ending.too_many) return process::too_many_processes();
  return "ends the process that loads it by " +
         (ending.signal != 0 ? process::signal_text(ending.signal)
                             : "exit(" + std::to_string(ending.exit_code) + ")");
}

}  // namespace

Result<std::string> ask_in_child(const std::function<Result<std::string>()>& find_out,
                                 std::chrono::milliseconds longest) {
  const auto latest = Clock::now() + longest;
  const auto started = process::Child::start(
      process::Copy{.work = [&](int pipe) { return answer_in_child(find_out, pipe); },
                    .err = STDERR_FILENO,
                    .most_bytes = kLongestAnswer_bytes + 1});
  if (!started) return started.error();
  process::Child& child = **started;
  std::optional<Result<std::string>> answer;
  const auto is_too_long = [&] { return child.out().size() > kLongestAnswer_bytes; };
  child.listen([&] {
    answer = read_answer(child.out());
    return !answer && !is_too_long() && Clock::now() < latest;
  });
  if (!answer) answer = read_answer(child.out());
  if (answer) return *std::move(answer);
  if (child.ending()) return Error{Errc::incompatible, how_it_ended(*child.ending())};
  if (is_too_long()) return Error{Errc::incompatible, "gives an answer of more than 256 MiB"};
  const auto seconds = std::chrono::duration<double>(longest).count();
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "does not come to an end within %g s", seconds);
  return Error{Errc::incompatible, text.data()};
}

}  // namespace weft::host
