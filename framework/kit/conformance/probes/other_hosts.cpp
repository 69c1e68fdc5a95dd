// SPDX-License-Identifier: Apache-2.0
#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <new>

#include "host/records/record.hpp"
#include "kit/conformance/probes/passages.hpp"

namespace weft::conformance {
namespace {

constexpr std::size_t kPage = 4096;
constexpr std::size_t kGrowth = 256;  ///< [bytes] that a later host adds to each struct
constexpr int kUnknown = 0xAB;
constexpr std::size_t kWall = 64, kLine = 64;  ///< [bytes]

// Where the structs of 1.0 end, which no later version changes.
constexpr std::size_t kHostBytes = offsetof(weft_host, get_extension) + sizeof(void*);
constexpr std::size_t kCallBytes = offsetof(weft_call, reserved) + sizeof(std::int32_t);
constexpr std::size_t kCreateBytes = offsetof(weft_create, context) + sizeof(void*);
constexpr std::size_t kErrorBytes = offsetof(weft_error, subject) + sizeof(weft_error::subject);

std::uint32_t size_of(std::size_t bytes) { return static_cast<std::uint32_t>(bytes); }

}  // namespace

/// The content of a replaced call's context.
struct OtherHost::Stay {
  OtherHost& host;
  const weft_call& call;
};

struct Forward {
  static const OtherHost::Stay& stay(const weft_call* call) {
    return *static_cast<const OtherHost::Stay*>(call->context);
  }
  static void* alloc(const weft_call* call, const weft_output* output) {
    const OtherHost::Stay& in = stay(call);
    void* memory = in.call.host->alloc(&in.call, output);
    if (memory == nullptr) return nullptr;
    return in.host.given(memory, std::string(output->slot) + "/" + output->array,
                         host::array_bytes(output->dtype, output->ndim, output->shape));
  }
  static std::int32_t cancelled(const weft_call* call) {
    return stay(call).call.host->cancelled(&stay(call).call);
  }
  static void log(const weft_call* call, std::int32_t level, const char* text) {
    stay(call).host.logged(text);
    stay(call).call.host->log(&stay(call).call, level, text);
  }
  static std::int32_t invoke(const weft_call* call, weft_invocation* asked, weft_error* error) {
    const OtherHost::Stay& in = stay(call);
    const std::int32_t status = in.call.host->invoke(&in.call, asked, error);
    in.host.invoked(asked->component, status, *error);
    return status;
  }
  static std::int32_t adopt(const weft_call* call, const weft_output* output) {
    const weft_call& asked = stay(call).call;
    return asked.host->adopt(&asked, output);
  }
  static const void* get_extension(const weft_host* /*host*/, void* /*context*/,
                                   const char* /*name*/) {
    return nullptr;
  }
};

const weft_call& OtherHost::dressed(const weft_call& call, const weft_host& host) {
  call_ = std::make_unique<weft_call>(call);
  host_ = std::make_unique<weft_host>(host);
  call_->host = host_.get();
  return *call_;
}

namespace {

constexpr weft_host kForwarding{kHostBytes,
                                WEFT_ABI_MAJOR,
                                WEFT_ABI_MINOR,
                                "another host",
                                "",
                                &Forward::alloc,
                                &Forward::cancelled,
                                &Forward::log,
                                &Forward::invoke,
                                &Forward::adopt,
                                &Forward::get_extension};

}  // namespace

std::int32_t OtherHost::prepare(const weft_component& component, void* self, const weft_call& call,
                                std::span<const weft_record> inputs, weft_error* error) {
  Stay stay{*this, call};
  weft_call with = call;
  with.context = &stay;
  const std::int32_t status =
      Passage::prepare(component, self, dressed(with, kForwarding), inputs, error);
  left(status);
  return status;
}

std::int32_t OtherHost::process(const weft_component& component, void* self, const weft_call& call,
                                std::span<const weft_record> inputs, weft_error* error) {
  Stay stay{*this, call};
  weft_call with = call;
  with.context = &stay;
  const std::int32_t status =
      Passage::process(component, self, dressed(with, kForwarding), inputs, error);
  left(status);
  return status;
}

void* StingyHost::given(void* memory, const std::string& /*name*/, std::int64_t /*bytes*/) {
  return asked_++ == refused_ ? nullptr : memory;
}

void StingyHost::left(std::int32_t status) {
  if (has_refused() && !answer_) answer_ = status;
}

void* WalledHost::given(void* memory, const std::string& name, std::int64_t bytes) {
  Room room{memory, static_cast<std::size_t>(bytes), {}, nullptr};
  room.memory.resize(room.bytes + kWall + kLine, std::byte{kUnknown});
  const auto start = reinterpret_cast<std::uintptr_t>(room.memory.data());
  room.begin = room.memory.data() + (kLine - start % kLine) % kLine;
  std::byte* const begin = room.begin;
  rooms_.insert_or_assign(name, std::move(room));  // the host forgets the earlier one, too
  return begin;
}

/// Hands what was written to the host, and looks at the walls.
void WalledHost::left(std::int32_t /*status*/) {
  for (const auto& [name, room] : rooms_) {
    const std::byte* const wall = room.begin + room.bytes;
    const bool holds =
        std::all_of(wall, wall + kWall, [](std::byte each) { return each == std::byte{kUnknown}; });
    if (!holds && breached_.empty()) breached_ = name;
    std::memcpy(room.of_host, room.begin, room.bytes);
  }
  rooms_.clear();
}

void* DirtyHost::given(void* memory, const std::string& /*name*/, std::int64_t bytes) {
  if (bytes > 0) std::memset(memory, dirt_, static_cast<std::size_t>(bytes));
  return memory;
}

EndOfPage::EndOfPage(std::size_t bytes)
    : mapped_(mmap(nullptr, 2 * kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)),
      data_(nullptr) {
  if (mapped_ == MAP_FAILED) throw std::bad_alloc();
  auto* start = static_cast<std::byte*>(mapped_);
  mprotect(start + kPage, kPage, PROT_NONE);
  data_ = start + kPage - bytes;
}

EndOfPage::~EndOfPage() { munmap(mapped_, 2 * kPage); }

namespace {

/// An error of the old size; its content is copied to the caller's error.
struct OldError {
  explicit OldError(weft_error& whose) : page(kErrorBytes), callers(whose) {
    std::memset(page.at<weft_error>(), 0, kErrorBytes);
    page.at<weft_error>()->struct_size = size_of(kErrorBytes);
  }
  ~OldError() {
    const std::uint32_t size = callers.struct_size;
    std::memcpy(&callers, page.at<weft_error>(), kErrorBytes);
    callers.struct_size = size;
  }
  OldError(const OldError&) = delete;
  OldError& operator=(const OldError&) = delete;

  EndOfPage page;
  weft_error& callers;
};

/// A struct with more behind it.
template <class T>
std::vector<std::uint64_t> grown(const T& known) {
  std::vector<std::uint64_t> words((sizeof(T) + kGrowth + 7) / 8);
  std::memset(words.data(), kUnknown, words.size() * 8);
  std::memcpy(words.data(), &known, sizeof(T));
  reinterpret_cast<T*>(words.data())->struct_size = size_of(sizeof(T) + kGrowth);
  return words;
}

template <class T>
T* as(std::vector<std::uint64_t>& words) {
  return reinterpret_cast<T*>(words.data());
}

/// An error with more fields at its end; its content is copied to the caller's error.
struct NewError {
  explicit NewError(weft_error& whose) : words(grown(whose)), callers(whose) {}
  ~NewError() {
    const std::uint32_t size = callers.struct_size;
    std::memcpy(&callers, words.data(), sizeof(weft_error));
    callers.struct_size = size;
  }
  NewError(const NewError&) = delete;
  NewError& operator=(const NewError&) = delete;

  std::vector<std::uint64_t> words;
  weft_error& callers;
};

}  // namespace

std::int32_t OldHost::create(const weft_component& component, const weft_create& with, void** self,
                             weft_error* error) {
  const EndOfPage host(kHostBytes), create(kCreateBytes);
  weft_host table = *with.host;
  table.struct_size = size_of(kHostBytes);
  std::memcpy(host.at<weft_host>(), &table, kHostBytes);
  std::memcpy(create.at<weft_create>(), &with, kCreateBytes);
  create.at<weft_create>()->struct_size = size_of(kCreateBytes);
  create.at<weft_create>()->host = host.at<weft_host>();
  const OldError old(*error);
  return component.create(create.at<weft_create>(), self, old.page.at<weft_error>());
}

std::int32_t OldHost::prepare(const weft_component& component, void* self, const weft_call& call,
                              std::span<const weft_record> inputs, weft_error* error) {
  const OldError old(*error);
  return OtherHost::prepare(component, self, call, inputs, old.page.at<weft_error>());
}

std::int32_t OldHost::process(const weft_component& component, void* self, const weft_call& call,
                              std::span<const weft_record> inputs, weft_error* error) {
  const OldError old(*error);
  return OtherHost::process(component, self, call, inputs, old.page.at<weft_error>());
}

const weft_call& OldHost::dressed(const weft_call& call, const weft_host& host) {
  pages_.clear();
  pages_.push_back(std::make_unique<EndOfPage>(kHostBytes));
  pages_.push_back(std::make_unique<EndOfPage>(kCallBytes));
  auto* const table = pages_[0]->at<weft_host>();
  auto* const with = pages_[1]->at<weft_call>();
  std::memcpy(table, &host, kHostBytes);
  std::memcpy(with, &call, kCallBytes);
  table->struct_size = size_of(kHostBytes);
  with->struct_size = size_of(kCallBytes);
  with->host = table;
  return *with;
}

std::int32_t NewHost::create(const weft_component& component, const weft_create& with, void** self,
                             weft_error* error) {
  std::vector<std::uint64_t> host = grown(*with.host), create = grown(with);
  as<weft_create>(create)->host = as<weft_host>(host);
  NewError later(*error);
  return component.create(as<weft_create>(create), self, as<weft_error>(later.words));
}

std::int32_t NewHost::prepare(const weft_component& component, void* self, const weft_call& call,
                              std::span<const weft_record> inputs, weft_error* error) {
  NewError later(*error);
  return OtherHost::prepare(component, self, call, inputs, as<weft_error>(later.words));
}

std::int32_t NewHost::process(const weft_component& component, void* self, const weft_call& call,
                              std::span<const weft_record> inputs, weft_error* error) {
  NewError later(*error);
  return OtherHost::process(component, self, call, inputs, as<weft_error>(later.words));
}

const weft_call& NewHost::dressed(const weft_call& call, const weft_host& host) {
  grown_ = {grown(host), grown(call)};
  as<weft_call>(grown_[1])->host = as<weft_host>(grown_[0]);
  return *as<weft_call>(grown_[1]);
}

}  // namespace weft::conformance
