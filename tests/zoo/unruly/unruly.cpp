// SPDX-License-Identifier: Apache-2.0
// A filter that breaks one rule of the contract, the one that it is told to.
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <thread>
#include <vector>
#include <weft/sdk/filter.hpp>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace {

enum class Misdeed {
  nothing,
  pads_nothing,
  runs_forward,
  wants_alignment,
  counts_arrays,
  counts_slots,
  reads_memory,
  ignores_null,
  ends_behind,
  silent_error,
  latin_error,
  counts_calls,
  counts_instances,
  remembers_frame,
  remembers_thread,
  uses_threads,
  shares,
  counts_prepares,
  needs_prepare,
  knows_newer_host,
  reads_on,
  knows_all_methods,
  locale,
  rounding,
  signals,
  folder,
  umask,
  environment,
  generator,
  seed,
  files,
  threads,
  memory,
  slow_memory,
  hunger,
  deaf,
  isolated
};

constexpr std::pair<const char*, Misdeed> kMisdeeds[] = {
    {"nothing", Misdeed::nothing},
    {"pads_nothing", Misdeed::pads_nothing},
    {"runs_forward", Misdeed::runs_forward},
    {"wants_alignment", Misdeed::wants_alignment},
    {"counts_arrays", Misdeed::counts_arrays},
    {"counts_slots", Misdeed::counts_slots},
    {"reads_memory", Misdeed::reads_memory},
    {"ignores_null", Misdeed::ignores_null},
    {"ends_behind", Misdeed::ends_behind},
    {"silent_error", Misdeed::silent_error},
    {"latin_error", Misdeed::latin_error},
    {"counts_calls", Misdeed::counts_calls},
    {"counts_instances", Misdeed::counts_instances},
    {"remembers_frame", Misdeed::remembers_frame},
    {"remembers_thread", Misdeed::remembers_thread},
    {"uses_threads", Misdeed::uses_threads},
    {"shares", Misdeed::shares},
    {"counts_prepares", Misdeed::counts_prepares},
    {"needs_prepare", Misdeed::needs_prepare},
    {"knows_newer_host", Misdeed::knows_newer_host},
    {"reads_on", Misdeed::reads_on},
    {"knows_all_methods", Misdeed::knows_all_methods},
    {"locale", Misdeed::locale},
    {"rounding", Misdeed::rounding},
    {"signals", Misdeed::signals},
    {"folder", Misdeed::folder},
    {"umask", Misdeed::umask},
    {"environment", Misdeed::environment},
    {"generator", Misdeed::generator},
    {"seed", Misdeed::seed},
    {"files", Misdeed::files},
    {"threads", Misdeed::threads},
    {"memory", Misdeed::memory},
    {"slow_memory", Misdeed::slow_memory},
    {"hunger", Misdeed::hunger},
    {"deaf", Misdeed::deaf},
    {"isolated", Misdeed::isolated}};

std::atomic<int> instances{0};
thread_local const void* last_seen = nullptr;

/// In a weft-worker, to which the name of its program is known.
bool is_in_a_worker() {
  char name[256] = {};
  return readlink("/proc/self/exe", name, sizeof(name) - 1) > 0 &&
         std::strstr(name, "weft-worker") != nullptr;
}

class Unruly final : public weft::Filter {
 public:
  explicit Unruly(weft::Params& p) : number_(instances++) {
    std::string misdeed = "nothing";
    p.text("misdeed", misdeed, "what it does wrong");
    p.read("high", high_, "", {0.0, 1.0}, "at which its process ends if it is 1");
    p.read("low", low_, "", {0.0, 1.0}, "at which its process ends if high is 0.5 or more too");
    p.read("first", first_, "", {0.0, 9.0}, "of which the first instance decides, if it is not 0");
    for (const auto& [name, meaning] : kMisdeeds) {
      if (misdeed == name) misdeed_ = meaning;
    }
    if (does(Misdeed::files)) open("/dev/null", O_RDONLY | O_CLOEXEC);
  }
  ~Unruly() override {
    if (does(Misdeed::needs_prepare) && prepares_ == 0) std::abort();
  }

  weft::Result<void> prepare(const weft::PrepareInput&) override {
    ++prepares_;
    return {};
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const std::int64_t count = in.correspondences.count();
    if (count == 0) return weft::no_result("there is no match");
    weft::InlierMask mask{
        weft::Array<std::uint8_t>({count}, 0), weft::Array<double>({count}, 0.0), {}};
    bool any = false;
    for (std::int64_t i = 0; i < count; ++i) {
      mask.kept(i) = in.correspondences.kept(i);
      any = any || mask.kept(i) != 0;
    }
    if (!any) return weft::no_result("there is no match that is kept");
    act(in, count);
    if (does(Misdeed::seed)) mask.diag.set("drawn", in.call.rng().uniform());
    mask.diag.set("odd", odd_ ? 1.0 : 0.0);
    odd_ = false;
    return mask;
  }

  bool does(Misdeed what) const { return misdeed_ == what; }
  void be_odd() { odd_ = true; }

 private:
  void act(const weft::FilterInput& in, std::int64_t count) {
    const weft::Correspondences& matches = in.correspondences;
    const auto* px = matches.image_px.data();
    ++calls_;
    if (high_ == 1.0 || (high_ >= 0.5 && low_ >= 0.5)) std::abort();
    if (first_ != 0.0) {
      static const double kept = first_;
      if (kept != first_) be_odd();
    }
    switch (misdeed_) {
      case Misdeed::pads_nothing:
        if (count > 1 && std::memcmp(px + 2, matches.image_px.row(1), 16) != 0) be_odd();
        break;
      case Misdeed::runs_forward:
        if (count > 1 && matches.image_px.row(1) < px) be_odd();
        break;
      case Misdeed::wants_alignment:
        if (reinterpret_cast<std::uintptr_t>(px) % 64 == 8) be_odd();
        break;
      case Misdeed::counts_calls:
        if (calls_ > 1) be_odd();
        break;
      case Misdeed::counts_instances:
        if (number_ % 2 == 1) be_odd();
        break;
      case Misdeed::remembers_frame:
        if (in.call.frame() < last_frame_) be_odd();
        last_frame_ = in.call.frame();
        break;
      case Misdeed::remembers_thread:
        if (last_seen == nullptr && calls_ == 1 && getpid() != gettid()) be_odd();
        last_seen = this;
        break;
      case Misdeed::uses_threads:
        if (in.call.threads() > 1) be_odd();
        break;
      case Misdeed::shares:
        if (number_ > 4) be_odd();
        break;
      case Misdeed::counts_prepares:
        if (prepares_ > 1) be_odd();
        break;
      case Misdeed::isolated:
        if (is_in_a_worker()) be_odd();
        break;
      case Misdeed::generator:
        std::rand();
        break;
      case Misdeed::slow_memory:
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        [[fallthrough]];
      case Misdeed::memory:
        leaked_.push_back(new std::vector<double>(128, 1.0));
        break;
      case Misdeed::hunger:
        if (count > 50'000) std::vector<char>(static_cast<std::size_t>(count) * 200'000);
        break;
      case Misdeed::deaf:
        if (count > 50'000) work_for_a_while();
        break;
      case Misdeed::threads:
        std::thread([] { std::this_thread::sleep_for(std::chrono::hours(1)); }).detach();
        break;
      default:
        change_the_process();
    }
  }

  void change_the_process() const {
    if (does(Misdeed::locale)) std::setlocale(LC_ALL, "C.UTF-8");
#if defined(__x86_64__)
    if (does(Misdeed::rounding)) _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
#endif
    if (does(Misdeed::signals)) ::signal(SIGUSR1, SIG_IGN);
    if (does(Misdeed::folder) && chdir("/") != 0) std::abort();
    if (does(Misdeed::umask)) ::umask(0);
    if (does(Misdeed::environment)) setenv("ZOO_UNRULY", "1", 1);
  }

  static void work_for_a_while() {
    const std::clock_t end = std::clock() + 5 * CLOCKS_PER_SEC / 2;  // of processor time
    while (std::clock() < end) continue;
  }

  Misdeed misdeed_ = Misdeed::nothing;
  double high_ = 0.0, low_ = 0.0, first_ = 0.0;
  int number_, calls_ = 0, prepares_ = 0;
  std::uint64_t last_frame_ = 0;
  bool odd_ = false;
  std::vector<std::vector<double>*> leaked_;
};

/// Before the SDK sees a call.
std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error) {
  auto& unruly = *static_cast<Unruly*>(self);
  if (unruly.does(Misdeed::counts_arrays)) {
    for (std::uint64_t i = 0; i < inputs[0].count; ++i) {
      if (std::strncmp(inputs[0].arrays[i].name, "x.", 2) == 0) unruly.be_odd();
    }
  }
  if (unruly.does(Misdeed::counts_slots) && count > 0 && inputs[0].slot[0] == 'x') unruly.be_odd();
  if (unruly.does(Misdeed::knows_newer_host) && call->struct_size != sizeof(weft_call)) {
    unruly.be_odd();
  }
  if (unruly.does(Misdeed::reads_on)) {
    volatile std::uint64_t behind = *reinterpret_cast<const std::uint64_t*>(call + 1);
    static_cast<void>(behind);
  }
  if (unruly.does(Misdeed::knows_all_methods) && call->method != 0) return WEFT_OK;
  const std::int32_t status =
      weft::detail::Functions<Unruly>::process(self, call, inputs, count, error);
  if (status > WEFT_DEGENERATE) {
    if (unruly.does(Misdeed::silent_error)) error->message[0] = '\0';
    if (unruly.does(Misdeed::latin_error)) std::strcpy(error->message, "zu sp\xE4t");
    return status;
  }
  const std::int64_t shape[] = {4};
  const bool asks = unruly.does(Misdeed::reads_memory) || unruly.does(Misdeed::ignores_null) ||
                    unruly.does(Misdeed::ends_behind);
  if (!asks) return status;
  auto* more = static_cast<double*>(
      call->host->alloc(call, "inlier_mask", "inlier_mask/1", "diag.more", WEFT_F64, 1, shape));
  if (more == nullptr) return status;
  const bool is_dirty = std::memcmp(more, "\x55\x55", 2) == 0;
  for (int i = 0; i < 4; ++i) {
    more[i] = is_dirty && unruly.does(Misdeed::reads_memory) ? 1.0 : 0.0;
  }
  if (unruly.does(Misdeed::ends_behind)) more[4] = 0.0;
  return status;
}

/// Marks too few matches where the truth is NaN.
class Truthful final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{.needs = "ground_truth", .uses_truth = true};
  explicit Truthful(weft::Params&) {}

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    std::int64_t count = in.correspondences.count();
    const auto& truth = (*in.ground_truth).match_xy_px;
    if (count > 0 && truth.present() && std::isnan(truth(0, 0))) --count;
    return weft::InlierMask{
        weft::Array<std::uint8_t>({count}, 0), weft::Array<double>({count}, 0.0), {}};
  }
};

constexpr auto kComponents = [] {
  auto all = std::to_array<weft_component>(
      {WEFT_COMPONENT(Unruly, "filters/zoo_unruly", "1.0.0", "Breaks the rule that it is told to."),
       WEFT_COMPONENT(Truthful, "filters/zoo_truthful", "1.0.0", "Cannot bear the unknown.")});
  all[0].process = &process;
  return all;
}();
constexpr auto kPointers = weft::detail::pointers_to(kComponents);

}  // namespace

const weft_library_table weft_library = {WEFT_ABI_MAGIC,
                                         WEFT_ABI_MAJOR,
                                         WEFT_ABI_MINOR,
                                         sizeof(weft_library_table),
                                         kComponents.size(),
                                         kPointers.data(),
                                         WEFT_ISA,
                                         WEFT_COMPILER,
                                         WEFT_NEEDS_MINOR,
                                         0,
                                         0,
                                         {0, 0, 0, 0}};
