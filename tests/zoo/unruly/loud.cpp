// SPDX-License-Identifier: Apache-2.0
// A library that is heard when it is loaded, and wants more than a library should.
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <thread>
#include <weft/sdk/filter.hpp>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

// Seen by everybody, as it is linked without the version script.
extern "C" {
__attribute__((visibility("default"), tls_model("initial-exec"))) __thread int zoo_loud_counter = 0;
}

namespace {

class Loud final : public weft::Filter {
 public:
  explicit Loud(weft::Params&) {
    const int file = open("/etc/passwd", O_RDONLY | O_CLOEXEC);
    if (file >= 0) close(file);
    ++zoo_loud_counter;
  }
  weft::Result<weft::InlierMask> filter(const weft::FilterInput&) override {
    return weft::no_result("never finds one");
  }
};

const bool kIsLoaded = [] {
  std::puts("here I am");
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
#if defined(__x86_64__)
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
#endif
  std::thread([] { std::this_thread::sleep_for(std::chrono::hours(1)); }).detach();
  return true;
}();

}  // namespace

WEFT_PLUGIN(Loud, "filters/zoo_loud", "1.0.0", "Is heard.")
