// SPDX-License-Identifier: Apache-2.0
// Overhead of the host: a call, a call of another process, a death, a start. Each figure is a
// median. Compared variants are measured by turns, in the same seconds.
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>
#include <weft/core/statistics.hpp>
#include <weft/data/image.hpp>

#include "component.hpp"
#include "host/calling/stopwatch.hpp"
#include "scenes.hpp"

namespace weft::bench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

template <class T>
T need(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().where + ": " + result.error().message);
  return *std::move(result);
}

template <class Unit>
double since(Clock::time_point start) {
  return std::chrono::duration<double, typename Unit::period>(Clock::now() - start).count();
}

/// Components that do next to nothing, here or in workers.
class IdleContext {
 public:
  host::Instance& make(const std::string& id, const std::string& params,
                       const host::Isolation* isolation = nullptr) {
    const auto document = need(yaml::parse("{use: " + id + ", params: " + params + "}", id));
    std::vector<yaml::Problem> problems;
    specs_.push_back(host::resolve_component(registry_, *document.root.find("use"),
                                             document.root.find("params"),
                                             host::PathRules::of_process({"/"}, "/tmp"), problems));
    if (!specs_.back()) throw std::runtime_error(id + ": " + problems.front().message);
    host::Instance& made =
        *need(isolation != nullptr ? context.instantiate_isolated(*specs_.back(), id, *isolation)
                                   : context.instantiate(*specs_.back(), id));
    const SheetScene scene;
    const auto ready = context.prepare(made, *record_of(scene.templ), *record_of(scene.camera));
    if (!ready) throw std::runtime_error(id + ": " + ready.error().message);
    return made;
  }

  /// An image as a source of this execution context leaves it.
  host::RecordPtr image(std::int64_t width, std::int64_t height) {
    const auto record = host::Record::make(Image::kType, context.memory(), arena_);
    Image typed;
    typed.pixels = Array<std::uint8_t>({height, width}, 7);
    auto done = write_record(
        typed, [&](const char* name, std::int32_t dtype, int ndim, const std::int64_t* shape) {
          return record->allocate(name, dtype, ndim, shape);
        });
    if (done) done = context.admit(*record, "image");
    if (!done) throw std::runtime_error(done.error().message);
    return record;
  }

 private:
  const host::Registry registry_ = host::Registry::scan({{WEFT_IDLE_PLUGINS, "benchmark"}});
  std::deque<std::optional<host::ComponentSpec>> specs_;
  std::shared_ptr<host::SharedArena> arena_ = need(host::SharedArena::create());

 public:
  host::ExecutionContext context{1, {}, arena_};
};

host::Isolation isolated() { return {WEFT_WORKER, {}}; }

/// The same call without a contract.
struct Callee {
  virtual ~Callee() = default;
  virtual int call(int value) = 0;
};
struct Nothing final : Callee {
  int call(int value) override { return value; }
};

/// A warm call of a component that does nothing, with its timing, beside a virtual function.
void warm_call(benchmark::State& state) {
  constexpr int kCalls = 64;
  IdleContext idle;
  host::Instance& sink = idle.make("sinks/bench.nothing", "{}");
  const auto time = record_of(Time{0.5});
  const weft_record inputs[] = {time->view("time")};
  std::unique_ptr<Callee> callee = std::make_unique<Nothing>();
  std::vector<double> calls_ns, virtual_ns, clocks_ns;
  std::uint64_t allocated = 0;
  for (auto each : state) {
    auto start = Clock::now();
    for (int i = 0; i < kCalls; ++i) {
      Callee* called = callee.get();
      benchmark::DoNotOptimize(called);
      benchmark::DoNotOptimize(called->call(i));
    }
    virtual_ns.push_back(since<std::chrono::nanoseconds>(start) / kCalls);
    start = Clock::now();
    for (int i = 0; i < kCalls; ++i) benchmark::DoNotOptimize(host::Stopwatch().spent());
    clocks_ns.push_back(since<std::chrono::nanoseconds>(start) / kCalls);
    const std::uint64_t before = host::allocations_of_process().blocks;
    start = Clock::now();
    for (int i = 0; i < kCalls; ++i) {
      benchmark::DoNotOptimize(idle.context.call(sink, 1, inputs, 0));
    }
    calls_ns.push_back(since<std::chrono::nanoseconds>(start) / kCalls);
    allocated = host::allocations_of_process().blocks - before;
    idle.context.times().take(0);
  }
  state.counters["call_ns"] = median(calls_ns);
  state.counters["virtual_ns"] = median(virtual_ns);
  state.counters["clocks_ns"] = median(clocks_ns);  // wall clock and CPU clock in each call
  state.counters["beyond_ns"] = median(calls_ns) - median(virtual_ns);
  state.counters["allocations_a_call"] = static_cast<double>(allocated) / kCalls;
}

/// A detector that reads one row of an image of 640x480, here and in a worker.
void hop(benchmark::State& state) {
  IdleContext idle;
  const host::Isolation isolation = isolated();
  host::Instance& near = idle.make("detectors/bench.glance", "{}");
  host::Instance& far = idle.make("detectors/bench.glance", "{}", &isolation);
  const auto image = idle.image(640, 480);
  const weft_record inputs[] = {image->view("image")};
  const auto once = [&](host::Instance& instance) {
    const auto start = Clock::now();
    const host::Outcome outcome = idle.context.call(instance, 0, inputs, 0);
    const double us = since<std::chrono::microseconds>(start);
    if (outcome.status != WEFT_OK) throw std::runtime_error(outcome.error.message);
    return us;
  };
  std::vector<double> near_us, far_us;
  for (int i = 0; i < 100; ++i) once(near), once(far);
  for (auto each : state) {
    near_us.push_back(once(near));
    far_us.push_back(once(far));
    idle.context.times().take(0);
  }
  state.counters["here_us"] = median(near_us);
  state.counters["apart_us"] = median(far_us);
  state.counters["hop_us"] = median(far_us) - median(near_us);
  state.counters["hop_p10_us"] = percentile(far_us, 10.0) - percentile(near_us, 10.0);
  state.counters["hop_p95_us"] = percentile(far_us, 95.0) - percentile(near_us, 95.0);
}

/// From the call in which the worker dies to the next answer.
void death(benchmark::State& state, int prepare_ms, bool keeps_spare) {
  IdleContext idle;
  host::Isolation isolation = isolated();
  isolation.keeps_spare = keeps_spare;
  host::Instance& far =
      idle.make("detectors/bench.glance",
                "{last_frame: 1, prepare_ms: " + std::to_string(prepare_ms) + "}", &isolation);
  const auto image = idle.image(640, 480);
  const weft_record inputs[] = {image->view("image")};
  std::vector<double> ms;
  for (auto each : state) {
    idle.context.call(far, 0, inputs, 0);
    // The worker lives this long before its death, and a spare is ready.
    std::this_thread::sleep_for(std::chrono::milliseconds(2 * prepare_ms + 100));
    const auto start = Clock::now();
    const bool died = idle.context.call(far, 0, inputs, 1).status == WEFT_ERROR;
    const bool answered = idle.context.call(far, 0, inputs, 2).status == WEFT_OK;
    ms.push_back(since<std::chrono::milliseconds>(start));
    if (!died || !answered) throw std::runtime_error("the worker did not die, or not once");
    idle.context.times().take();
  }
  state.counters["answer_ms"] = median(ms);
  state.counters["answer_max_ms"] = percentile(ms, 100.0);
}

/// Wall-clock time and CPU time of a program.
struct Took {
  double ms = 0.0, processor_ms = 0.0;
};

Took time_of(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&quiet, stream, "/dev/null", O_WRONLY, 0);
  }
  const auto start = Clock::now();
  pid_t child = 0;
  const int code = posix_spawn(&child, arguments[0], &quiet, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&quiet);
  rusage used{};
  int status = 0;
  if (code != 0 || wait4(child, &status, 0, &used) != child || status != 0) {
    throw std::runtime_error(words[0] + " " + words[1] + " failed");
  }
  const auto ms_of = [](const timeval& time) {
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_usec);
  };
  return {since<std::chrono::milliseconds>(start), ms_of(used.ru_utime) + ms_of(used.ru_stime)};
}

/// A folder that is gone with this object.
struct TemporaryFolder {
  TemporaryFolder()
      : path(fs::temp_directory_path() / ("host_benchmark." + std::to_string(getpid()))) {
    fs::create_directory(path);
  }
  ~TemporaryFolder() { fs::remove_all(path); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  fs::path path;
};

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Copies one library to this number of files, each with a separate manifest and ids.
void fill(const fs::path& folder, int count) {
  const fs::path built = WEFT_IDLE_PLUGINS;
  for (const auto& entry : fs::directory_iterator(built)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".so")) continue;
    const std::string stem = name.substr(0, name.size() - 3);
    const std::string manifest = text_of(built / (stem + ".plugin.yaml"));
    for (int i = 0; i < count; ++i) {
      const std::string own = stem + "_" + std::to_string(i);
      fs::copy_file(entry.path(), folder / (own + ".so"));
      std::string text = manifest;
      for (const std::string id : {"bench.nothing", "bench.glance"}) {
        for (std::size_t at = 0; (at = text.find(id, at)) != std::string::npos; at += id.size()) {
          text.insert(at + id.size(), std::to_string(i));
        }
      }
      std::ofstream(folder / (own + ".plugin.yaml")) << text;
    }
    return;
  }
  throw std::runtime_error("there is no library in " + built.string());
}

/// `weft plugins list` with 200 more plugins, beside a start of the program that does nothing.
void plugins_list(benchmark::State& state) {
  const TemporaryFolder folder;
  fill(folder.path, 200);
  std::vector<double> with_ms, without_ms;
  for (auto each : state) {
    without_ms.push_back(time_of({WEFT_PROGRAM, "plugins", "list"}).processor_ms);
    with_ms.push_back(
        time_of({WEFT_PROGRAM, "--plugin-path", folder.path.string(), "plugins", "list"})
            .processor_ms);
  }
  state.counters["processor_ms"] = median(with_ms);
  state.counters["without_them_ms"] = median(without_ms);
  state.counters["of_200_ms"] = median(with_ms) - median(without_ms);
}

/// A whole run of one frame, its summary included.
void first_frame(benchmark::State& state) {
  const TemporaryFolder folder;
  std::vector<double> ms;
  for (auto each : state) {
    fs::remove_all(folder.path / "run");
    ms.push_back(time_of({WEFT_PROGRAM, "run", WEFT_DEMO, "--quiet", "--set", "source.frames=1",
                          "--out", (folder.path / "run").string()})
                     .ms);
  }
  state.counters["run_of_one_frame_ms"] = median(ms);
}

BENCHMARK(warm_call)->Iterations(2000)->Unit(benchmark::kMicrosecond);
BENCHMARK(hop)->Iterations(3000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(death, of_a_quick_starter, 0, false)
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(death, of_a_slow_starter_with_a_spare, 200, true)
    ->Iterations(10)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(death, of_a_slow_starter_without_one, 200, false)
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(plugins_list)->Iterations(10)->Unit(benchmark::kMillisecond);
BENCHMARK(first_frame)->Iterations(5)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace weft::bench

BENCHMARK_MAIN();
