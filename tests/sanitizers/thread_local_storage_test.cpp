// SPDX-License-Identifier: Apache-2.0
// LeakSanitizer looks through the thread-local storage of loaded libraries when a program ends, at
// whatever place in a page that storage lies, and must not fail there. Passes by ending with 0.
#include <dlfcn.h>
#include <unistd.h>

#include <cstdio>
#include <latch>
#include <memory>
#include <thread>
#include <vector>

int main() {
  // Storage of a library is allocated where a thread first uses it. Small blocks of one thread are
  // neighbours, so that a page's worth of threads, each with one more block before it, meets every
  // place.
  constexpr int kThreads = 256;
  void* library = dlopen(WEFT_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  void* symbol = library == nullptr ? nullptr : dlsym(library, "own_a_block");
  if (symbol == nullptr) {
    std::fprintf(stderr, "%s\n", dlerror());
    return 1;
  }
  auto* own_a_block = reinterpret_cast<void (*)()>(symbol);

  static std::latch ready(kThreads);
  for (int i = 0; i < kThreads; ++i) {
    std::thread([i, own_a_block] {
      std::vector<std::unique_ptr<void*>> before(i);
      for (auto& block : before) block = std::make_unique<void*>();
      own_a_block();
      ready.count_down();
      pause();
    }).detach();
  }
  ready.wait();
  return 0;
}
