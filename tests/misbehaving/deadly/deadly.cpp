// SPDX-License-Identifier: Apache-2.0
// Components that would take their host with them: made to run in a worker.
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>
#include <weft/sdk/filter.hpp>
#include <weft/sdk/pass.hpp>

namespace {

enum class Action {
  none,
  crash,
  abort,
  exit,
  kill,
  hang,
  obey,
  scribble,
  log,
  large,
  fault,
  overflow,
  terminate,
  quit,
  spoil,
  overread,
  leave,
  leave_session,
  fork_twice,
  multiply,
  print,
  warn,
  at_exit,
  shout
};
enum class Place { process, create, prepare };

/// Dies of a signal as it does without anybody's handler for it.
void die_of(int signal) {
  ::signal(signal, SIG_DFL);
  raise(signal);
}

void write_where_nothing_is() {
  void* const nothing = mmap(nullptr, 4096, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  *static_cast<volatile int*>(nothing) = 1;
}

void read_at(const volatile double* place) {
  const double read = *place;
  static_cast<void>(read);
}

/// Is in use until the process ends, and faults where it is destroyed before.
struct InUse {
  ~InUse() { write_where_nothing_is(); }
};

/// Calls itself until the stack is full. The compiler cannot infer that `more` never changes.
int fill_the_stack(const volatile bool& more) {
  volatile char room[4096];
  room[0] = 1;
  return (more ? fill_the_stack(more) : 0) + room[0];
}

/// Writes into every socket of the process; one of them leads to the host.
void scribble() {
  for (int file = 3; file < 64; ++file) {
    const char nonsense[64] = "neither head nor tail";
    if (send(file, nonsense, sizeof(nonsense), MSG_NOSIGNAL) < 0) continue;
  }
}

/// A process that keeps all files of this one open for an hour; `detached`: in a separate session
/// and below another parent.
void leave_a_process(const std::string& name, bool detached) {
  if (fork() != 0) return;
  if (detached) setsid();
  if (detached && fork() != 0) _exit(0);
  prctl(PR_SET_NAME, name.c_str());
  std::this_thread::sleep_for(std::chrono::hours(1));
  _exit(0);
}

/// Prints 64 MiB.
void print_much() {
  const std::string line(1023, 'x');
  for (int i = 0; i < 65536; ++i) std::puts(line.c_str());
  std::fflush(stdout);
}

/// Logs from eight threads at once: a text of 64 MiB each, and many short ones.
void shout(const weft::Call& call) {
  const std::string text(std::size_t{64} << 20, 'x');
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      call.log_warning(text);
      for (int j = 0; j < 2000; ++j) call.log_warning("short");
    });
  }
  for (std::thread& thread : threads) thread.join();
}

/// Keeps every match until it performs its action.
class Deadly final : public weft::Filter {
 public:
  explicit Deadly(weft::Params& p) {
    p.choice("deed", action_,
             {{"none", Action::none},
              {"crash", Action::crash},
              {"abort", Action::abort},
              {"exit", Action::exit},
              {"kill", Action::kill},
              {"hang", Action::hang},
              {"obey", Action::obey},
              {"scribble", Action::scribble},
              {"log", Action::log},
              {"large", Action::large},
              {"fault", Action::fault},
              {"overflow", Action::overflow},
              {"terminate", Action::terminate},
              {"quit", Action::quit},
              {"spoil", Action::spoil},
              {"overread", Action::overread},
              {"leave", Action::leave},
              {"leave_session", Action::leave_session},
              {"fork_twice", Action::fork_twice},
              {"multiply", Action::multiply},
              {"print", Action::print},
              {"warn", Action::warn},
              {"at_exit", Action::at_exit},
              {"shout", Action::shout}},
             "what it does");
    p.choice("where", where_,
             {{"process", Place::process}, {"create", Place::create}, {"prepare", Place::prepare}},
             "in which function");
    p.read("frame", frame_, "", {-1, 1e6}, "in which frame; -1 for all");
    p.text("child", child_, "name of the processes that it leaves behind");
    p.read("prepare_ms", prepare_ms_, "ms", {0, 10'000}, "time that it takes to prepare");
    if (where_ == Place::create) act();
  }

  weft::Result<void> prepare(const weft::PrepareInput&) override {
    if (where_ == Place::prepare) act();
    std::this_thread::sleep_for(std::chrono::milliseconds(prepare_ms_));
    prepared_ = true;
    return {};
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const std::int64_t n = in.correspondences.count();
    weft::InlierMask mask{weft::Array<std::uint8_t>({n}, 0), weft::Array<double>({n}, 0.0), {}};
    mask.diag.set("prepared", prepared_ ? 1.0 : 0.0);
    mask.diag.set("process", static_cast<double>(getpid()));
    if (where_ != Place::process) return mask;
    if (frame_ >= 0 && static_cast<std::uint64_t>(frame_) != in.call.frame()) return mask;
    act();
    if (action_ == Action::spoil) *const_cast<std::uint8_t*>(in.correspondences.kept.data()) = 0;
    if (action_ == Action::overread) read_at(in.correspondences.score.data() + n + 16);
    for (int i = 0; action_ == Action::warn && i < 20'000; ++i) {
      in.call.log_warning("warning number " + std::to_string(i));
    }
    if (action_ == Action::shout) shout(in.call);
    if (action_ == Action::log) in.call.log_warning("so far so good");
    if (action_ == Action::large) mask.diag.set("large", weft::Array<double>({5'000'000}, 0.0));
    while (action_ == Action::obey) {
      if (in.call.cancelled()) return weft::Error{weft::Errc::cancelled, "as you wish"};
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return mask;
  }

 private:
  void act() const {
    if (action_ == Action::none) return;
    std::printf("out it goes\n");
    std::fprintf(stderr, "these are\nlast words\n");
    if (action_ == Action::crash) die_of(SIGSEGV);
    if (action_ == Action::abort) die_of(SIGABRT);
    if (action_ == Action::kill) die_of(SIGKILL);
    if (action_ == Action::exit) _exit(7);
    if (action_ == Action::scribble) scribble();
    if (action_ == Action::leave || action_ == Action::leave_session) {
      leave_a_process(child_, action_ == Action::leave_session);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      die_of(SIGABRT);
    }
    if (action_ == Action::fork_twice && fork() == 0) prctl(PR_SET_NAME, child_.c_str());
    while (action_ == Action::multiply) leave_a_process(child_, true);
    if (action_ == Action::print) print_much();
    if (action_ == Action::fault) write_where_nothing_is();
    if (action_ == Action::overflow) {
      const volatile bool more = true;
      std::printf("%d", fill_the_stack(more));
    }
    if (action_ == Action::terminate) std::thread([] { throw 1; }).join();
    if (action_ == Action::quit) {
      static const InUse by_other_threads;
      std::exit(0);
    }
    if (action_ == Action::at_exit) {
      std::atexit([] {
        std::puts("printed at the end");
        std::abort();
      });
    }
    while (action_ == Action::hang) std::this_thread::sleep_for(std::chrono::hours(1));
  }

  Action action_ = Action::none;
  Place where_ = Place::process;
  int frame_ = -1;
  std::string child_ = "test_left";
  int prepare_ms_ = 0;
  bool prepared_ = false;
};

/// Ends the process during the check of its parameters.
class Leaving final : public weft::Filter {
 public:
  explicit Leaving(weft::Params& p) { p.read("at_once", at_once_, "by _exit()"); }

  void check(weft::Mistakes&) const {
    if (at_once_) _exit(0);
    std::exit(0);
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput&) override {
    return weft::no_result("is never asked for one");
  }

 private:
  bool at_once_ = false;
};

/// Reports where a warp that another component made maps the template's third vertex.
class Reader final : public weft::Pass {
 public:
  static constexpr weft::About kAbout{.needs = "warp", .produces = "visibility"};

  explicit Reader(weft::Params&) {}

  weft::Result<weft::PassOutput> run(const weft::PassInput& in) override {
    const auto samples = weft::evaluate(in.call, *in.warp, {in.templ.flat_px, 0});
    if (!samples) return samples.error();
    const std::int64_t count = samples->xy_px.rows();
    weft::PassOutput out;
    out.visibility = {weft::Array<std::uint8_t>({count}, 0),
                      weft::Array<double>({count}, 0.0),
                      weft::Array<std::uint8_t>({count}, 0),
                      {}};
    out.visibility->diag.set("third_x_px", samples->xy_px(2, 0));
    return out;
  }
};

}  // namespace

WEFT_LIBRARY(WEFT_COMPONENT(Deadly, "filters/test_deadly", "1.0.0", "Takes its process with it."),
             WEFT_COMPONENT(Leaving, "filters/test_leaving", "1.0.0", "Leaves when it is asked."),
             WEFT_COMPONENT(Reader, "passes/test_reader", "1.0.0", "Evaluates a warp."))
