// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/probes/sealed_host.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <new>

namespace weft::conformance {
namespace {

constexpr std::size_t kSealedPage = 4096;

/// Pages that a signal handler can identify.
struct Known {
  std::atomic<const std::byte*> start{nullptr};  ///< null where it is free
  std::atomic<bool> is_left{false};
  std::size_t bytes = 0;
  const char* what = nullptr;
};
// Handlers reach nothing but objects with static storage.
std::array<Known, 256> all_known;

static_assert(std::atomic<const std::byte*>::is_always_lock_free);

Known* known_at(const std::byte* start) {
  const auto found = std::find_if(all_known.begin(), all_known.end(),
                                  [&](const Known& known) { return known.start == start; });
  return found != all_known.end() ? found : nullptr;
}

}  // namespace

/// Copies of structs of one type.
class SealedHost::Pages {
 public:
  Pages(const char* what, const void* from, std::size_t bytes)
      : bytes_((bytes / kSealedPage + 1) * kSealedPage),
        start_(mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)) {
    if (start_ == MAP_FAILED) throw std::bad_alloc();
    if (bytes > 0) std::memcpy(start_, from, bytes);
    Known* const known = known_at(nullptr);
    if (known == nullptr) return;  // a fault there is unexplained
    known->bytes = bytes_;
    known->what = what;
    known->is_left = false;
    known->start = static_cast<const std::byte*>(start_);
  }
  ~Pages() {
    if (Known* const known = of_this()) known->start = nullptr;
    munmap(start_, bytes_);
  }
  Pages(const Pages&) = delete;
  Pages& operator=(const Pages&) = delete;

  template <class T>
  T* at() const {
    return static_cast<T*>(start_);
  }
  void seal() const { mprotect(start_, bytes_, PROT_READ); }
  void leave() const {
    if (Known* const known = of_this()) known->is_left = true;
    mprotect(start_, bytes_, PROT_NONE);
  }

 private:
  Known* of_this() const { return known_at(static_cast<const std::byte*>(start_)); }

  std::size_t bytes_;
  void* start_;
};

/// The structs of one call.
class SealedHost::Sealed {
 public:
  Sealed(const weft_call& call, std::span<const weft_record> inputs) {
    auto* records =
        add("the records of its inputs", inputs.data(), inputs.size())->at<weft_record>();
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      records[i].arrays = add("the array entries of its inputs", inputs[i].arrays, inputs[i].count)
                              ->at<weft_array>();
    }
    const auto* host = add("the function table of the host", call.host, 1)->at<weft_host>();
    auto* with = add("its weft_call", &call, 1)->at<weft_call>();
    with->host = host;
    call_ = with;
    records_ = {records, inputs.size()};
    for (const auto& pages : all_) pages->seal();
  }
  const weft_call& call() const { return *call_; }
  std::span<const weft_record> records() const { return records_; }
  std::vector<std::unique_ptr<Pages>> left() && {
    for (const auto& pages : all_) pages->leave();
    return std::move(all_);
  }

 private:
  template <class T>
  Pages* add(const char* what, const T* from, std::size_t count) {
    all_.push_back(std::make_unique<Pages>(what, from, count * sizeof(T)));
    return all_.back().get();
  }

  std::vector<std::unique_ptr<Pages>> all_;
  const weft_call* call_ = nullptr;
  std::span<const weft_record> records_;
};

SealedHost::SealedHost() = default;
SealedHost::~SealedHost() = default;

template <class Call>
std::int32_t SealedHost::sealed(const weft_call& call, std::span<const weft_record> inputs,
                                Call&& then) {
  Sealed given(call, inputs);
  const std::int32_t status = then(given.call(), given.records());
  for (auto& pages : std::move(given).left()) left_.push_back(std::move(pages));
  return status;
}

std::int32_t SealedHost::prepare(const weft_component& component, void* self, const weft_call& call,
                                 std::span<const weft_record> inputs, weft_error* error) {
  return sealed(call, inputs, [&](const weft_call& with, std::span<const weft_record> records) {
    return Passage::prepare(component, self, with, records, error);
  });
}

std::int32_t SealedHost::process(const weft_component& component, void* self, const weft_call& call,
                                 std::span<const weft_record> inputs, weft_error* error) {
  return sealed(call, inputs, [&](const weft_call& with, std::span<const weft_record> records) {
    return Passage::process(component, self, with, records, error);
  });
}

SealedPlace sealed_place(const void* address) {
  const auto* place = static_cast<const std::byte*>(address);
  for (const Known& known : all_known) {
    const std::byte* start = known.start;
    if (start != nullptr && place >= start && place < start + known.bytes) {
      return {known.what, known.is_left};
    }
  }
  return {};
}

}  // namespace weft::conformance
