// SPDX-License-Identifier: Apache-2.0
// A filter and a sink against the bare contract that use its rarer rules, or break them where the
// C++ SDK cannot. `act` selects what the filter does.
#include <sched.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>
#include <weft/budget.h>

#include <array>
#include <clocale>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>

namespace {

constexpr const char* kActs[] = {"none",
                                 "wrong_element_first",
                                 "device_first",
                                 "vendor_name_first",
                                 "second_view",
                                 "older_frame",
                                 "writes_replaced",
                                 "invokes_its_input",
                                 "invokes_first",
                                 "throws_without_text",
                                 "throws_in_destroy",
                                 "logs_escapes",
                                 "logs_without_end",
                                 "forks",
                                 "asks_for_its_time",
                                 "limit",
                                 "timer",
                                 "handler",
                                 "mask",
                                 "affinity",
                                 "priority",
                                 "locale",
                                 "folder",
                                 "terminate",
                                 "environment"};

struct Bare {
  std::string_view act;
};

/// An exception whose text is null.
struct Textless final : std::exception {
  const char* what() const noexcept override { return nullptr; }
};

std::int32_t describe(const weft_describe* sink, weft_error* /*error*/) {
  weft_parameter parameter{};
  parameter.struct_size = sizeof(parameter);
  const char* fallback = "none";
  parameter.default_value = {"act", WEFT_VALUE_CHOICE, 0, 1, &fallback, {}};
  parameter.unit = parameter.role = parameter.was = "";
  parameter.help = "what it does";
  parameter.choices = kActs;
  parameter.choice_count = std::size(kActs);
  sink->parameter(sink->context, &parameter);
  return WEFT_OK;
}

/// Changes what all code of the process shares.
void change_process(std::string_view act) {
  if (act == "limit") {
    rlimit files{};
    getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur -= 1;
    setrlimit(RLIMIT_NOFILE, &files);
  }
  const itimerval late{{0, 0}, {1000, 0}};
  if (act == "timer") setitimer(ITIMER_REAL, &late, nullptr);
  if (act == "handler") std::signal(SIGUSR1, SIG_IGN);
  sigset_t one;
  sigemptyset(&one);
  sigaddset(&one, SIGUSR2);
  if (act == "mask") pthread_sigmask(SIG_BLOCK, &one, nullptr);
  cpu_set_t first;
  CPU_ZERO(&first);
  CPU_SET(static_cast<unsigned>(sched_getcpu()), &first);
  if (act == "affinity") sched_setaffinity(0, sizeof(first), &first);
  if (act == "priority") setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + 1);
  if (act == "locale") std::setlocale(LC_ALL, "C.UTF-8");
  if (act == "folder") static_cast<void>(chdir("/"));
  if (act == "terminate") std::set_terminate([] { std::abort(); });
  if (act == "environment") setenv("TZ", "UTC+3", 1);
}

std::int32_t create(const weft_create* with, void** self, weft_error* /*error*/) {
  const std::string_view given =
      with->count > 0 ? *static_cast<const char* const*>(with->values[0].data) : "none";
  for (const char* act : kActs) {
    if (given == act) *self = new Bare{act};
  }
  change_process(given);
  return WEFT_OK;
}

std::int32_t prepare(void*, const weft_call*, const weft_record*, std::uint64_t, weft_error*) {
  return WEFT_OK;
}

std::int64_t count_matches(const weft_record* inputs, std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) {
    if (std::string_view(inputs[i].slot) == "correspondences") return inputs[i].arrays[0].shape[0];
  }
  return 0;
}

weft_output output_of(const char* array, std::int32_t dtype, const std::int64_t& length) {
  weft_output output{};
  output.struct_size = sizeof(output);
  output.dtype = dtype;
  output.slot = "inlier_mask";
  output.type = "inlier_mask/1";
  output.array = array;
  output.shape = &length;
  output.ndim = 1;
  output.frame = WEFT_NO_FRAME;
  return output;
}

/// Requests what the host must refuse; true if it gave it.
bool is_given(const Bare& bare, const weft_call* call, std::int64_t n) {
  weft_output asked = output_of("kept", WEFT_U8, n);
  if (bare.act == "wrong_element_first") asked.dtype = WEFT_F64;
  if (bare.act == "vendor_name_first") asked.array = "x.one_part";
  if (bare.act == "second_view") asked.view = 1;
  if (bare.act == "device_first") {
    asked.handle = 5;
    return call->host->adopt(call, &asked) != 0;
  }
  const bool must_be_refused = bare.act == "wrong_element_first" ||
                               bare.act == "vendor_name_first" || bare.act == "second_view";
  return must_be_refused && call->host->alloc(call, &asked) != nullptr;
}

std::int32_t invoke(const weft_call* call, std::uint64_t component, const weft_record* inputs,
                    std::uint64_t count, weft_error* error) {
  weft_invocation asked{};
  asked.struct_size = sizeof(asked);
  asked.component = component;
  asked.inputs = inputs;
  asked.input_count = count;
  asked.frame = call->frame;
  return call->host->invoke(call, &asked, error);
}

void log_much(const Bare& bare, const weft_call* call) {
  if (bare.act == "logs_escapes") {
    call->host->log(call, 1, "red \x1b[31m\nfake: line \xff");
    call->host->log(call, 77, std::string(5000, 'x').c_str());
  }
  for (int i = 0; bare.act == "logs_without_end" && i < 300'000; ++i) call->host->log(call, 1, "o");
}

std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error) {
  const Bare& bare = *static_cast<Bare*>(self);
  const std::int64_t n = count_matches(inputs, count);
  if (bare.act == "throws_without_text") throw Textless();
  if (bare.act == "asks_for_its_time") {
    const void* budget = call->host->get_extension(call->host, call->context, WEFT_BUDGET);
    const double left_ms = static_cast<const weft_budget*>(budget)->left_ms(call);
    call->host->log(call, 1, std::to_string(left_ms).c_str());
  }
  if (bare.act == "forks") {
    const pid_t copy = fork();
    if (copy == 0) return WEFT_OK;
    waitpid(copy, nullptr, 0);
  }
  if (bare.act == "invokes_first") return invoke(call, 1, inputs, count, error);
  if (bare.act == "invokes_its_input") {
    for (std::uint64_t i = 0; i < count; ++i) {
      if (inputs[i].producer == 0) continue;
      const std::int32_t status = invoke(call, inputs[i].producer, inputs, count, error);
      if (status != WEFT_OK) return status;
    }
  }
  log_much(bare, call);
  if (is_given(bare, call, n)) {
    std::strcpy(error->message, "the host gave what it must refuse");
    return WEFT_ERROR;
  }
  weft_output wanted = output_of("kept", WEFT_U8, n);
  if (bare.act == "older_frame") wanted.frame = 3;
  auto* kept = static_cast<std::uint8_t*>(call->host->alloc(call, &wanted));
  if (bare.act == "writes_replaced") {
    auto* const replaced = kept;
    kept = static_cast<std::uint8_t*>(call->host->alloc(call, &wanted));
    std::memset(replaced, 7, static_cast<std::size_t>(n));
  }
  const weft_output of_score = output_of("score", WEFT_F64, n);
  auto* score = static_cast<double*>(call->host->alloc(call, &of_score));
  for (std::int64_t i = 0; i < n; ++i) {
    kept[i] = 1;
    score[i] = 0.5;
  }
  return WEFT_OK;
}

void destroy(void* self) {
  const bool throws = static_cast<Bare*>(self)->act == "throws_in_destroy";
  delete static_cast<Bare*>(self);
  if (throws) throw std::runtime_error("the floor gave way");
}

std::int32_t take(void*, void*, void (*)(void*, std::uint64_t, const char*), weft_error*) {
  throw std::runtime_error("no hand is free");
}
std::int32_t answer(void*, std::uint64_t, std::uint64_t, const char*, weft_error*) {
  throw std::runtime_error("no ear is open");
}
constexpr weft_steering kSteering{sizeof(weft_steering), 0, &take, &answer};

/// The description of the library must succeed, so that it throws only where a test wants it.
const void* get_extension(const weft_component* component, const char* name) {
  if (std::getenv("WEFT_TEST_EXTENSIONS_THROW") != nullptr) {
    throw std::runtime_error("the shelf is empty");
  }
  const bool is_sink = std::string_view(component->id) == "sinks/test_bare";
  return is_sink && std::string_view(name) == WEFT_STEERING ? &kSteering : nullptr;
}

std::int32_t sink_process(void*, const weft_call*, const weft_record*, std::uint64_t, weft_error*) {
  return WEFT_OK;
}

constexpr weft_component component(const char* id, std::uint64_t methods,
                                   decltype(weft_component::process) process_of) {
  return {sizeof(weft_component),
          0,
          id,
          "1.0.0",
          "Uses the rarer rules of the contract.",
          "",
          "Apache-2.0",
          "exact",
          "",
          "",
          "",
          methods,
          &describe,
          &create,
          &prepare,
          process_of,
          &destroy,
          &get_extension};
}

constexpr weft_component kFilter = component("filters/test_bare", 1, &process);
constexpr weft_component kSink = component("sinks/test_bare", 7, &sink_process);
constexpr std::array<const weft_component*, 2> kPointers{&kFilter, &kSink};

}  // namespace

const weft_library_table weft_library = {WEFT_ABI_MAGIC,
                                         WEFT_ABI_MAJOR,
                                         WEFT_ABI_MINOR,
                                         sizeof(weft_library_table),
                                         kPointers.size(),
                                         WEFT_ABI_NAME,
                                         kPointers.data(),
                                         "",
                                         "by hand",
                                         0,
                                         0,
                                         0,
                                         {0, 0, 0, 0}};
