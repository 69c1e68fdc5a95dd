// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <weft/core/result.hpp>

/// The part of the C interface of ONNX Runtime that Weft calls. The interface is a table of
/// functions whose order never changes; later versions append to it.
namespace weft::inference::ort {

// Types that only the library defines.
struct Status;
struct Env;
struct Session;
struct Options;
struct MemoryInfo;
struct Value;
struct TensorInfo;

using Table = void (*const)();

/// The result of the only exported function, OrtGetApiBase().
struct ApiBase {
  Table* (*get_api)(std::uint32_t version);
  const char* (*version)();
};

/// The place of a function in the table.
template <class Function>
struct Slot {
  std::size_t place;
};

inline constexpr Slot<const char*(const Status*)> kErrorMessage{2};
inline constexpr Slot<Status*(int severity, const char* id, Env**)> kCreateEnv{3};
inline constexpr Slot<Status*(const Env*)> kDisableTelemetry{6};
inline constexpr Slot<Status*(const Env*, const void* bytes, std::size_t count, const Options*,
                              Session**)>
    kCreateSession{8};
inline constexpr Slot<Status*(Session*, const void* run_options, const char* const* input_names,
                              const Value* const* inputs, std::size_t input_count,
                              const char* const* output_names, std::size_t output_count,
                              Value** outputs)>
    kRun{9};
inline constexpr Slot<Status*(Options**)> kCreateOptions{10};
inline constexpr Slot<Status*(Options*, int threads)> kSetThreads{24};
inline constexpr Slot<Status*(const MemoryInfo*, void* data, std::size_t bytes,
                              const std::int64_t* shape, std::size_t axes, int type, Value**)>
    kCreateTensor{49};
inline constexpr Slot<Status*(Value*, void** data)> kTensorData{51};
inline constexpr Slot<Status*(const TensorInfo*, int* type)> kElementType{60};
inline constexpr Slot<Status*(const TensorInfo*, std::size_t* axes)> kAxisCount{61};
inline constexpr Slot<Status*(const TensorInfo*, std::int64_t* shape, std::size_t axes)> kShape{62};
inline constexpr Slot<Status*(const Value*, TensorInfo**)> kTensorInfo{65};
inline constexpr Slot<Status*(int allocator, int kind, MemoryInfo**)> kCreateMemoryInfo{69};
inline constexpr Slot<void(Env*)> kReleaseEnv{92};
inline constexpr Slot<void(Status*)> kReleaseStatus{93};
inline constexpr Slot<void(MemoryInfo*)> kReleaseMemoryInfo{94};
inline constexpr Slot<void(Session*)> kReleaseSession{95};
inline constexpr Slot<void(Value*)> kReleaseValue{96};
inline constexpr Slot<void(TensorInfo*)> kReleaseTensorInfo{99};
inline constexpr Slot<void(Options*)> kReleaseOptions{100};
inline constexpr Slot<Status*(Options*, const char* key, const char* value)> kAddOption{130};

/// Requested version of the table. ONNX Runtime 1.11 and all later versions offer it.
inline constexpr std::uint32_t kVersion = 11;

// Values of the enumerations in these functions.
inline constexpr int kFatal = 4;          ///< log severity
inline constexpr int kFloat = 1;          ///< element type
inline constexpr int kArena = 1;          ///< allocator
inline constexpr int kDefaultMemory = 0;  ///< kind of memory

template <class Object>
struct Release {
  void (*function)(Object*) = nullptr;
  void operator()(Object* object) const { function(object); }
};
/// An object of the library.
template <class Object>
using Owned = std::unique_ptr<Object, Release<Object>>;

/// The table of an open library.
class Api {
 public:
  /// Opens the library at the path in the environment variable WEFT_ONNXRUNTIME, or else the
  /// libonnxruntime.so.1 that the dynamic linker finds. It is never closed.
  static Result<Api> open();

  template <class Function>
  Function* operator[](Slot<Function> slot) const {
    return reinterpret_cast<Function*>(table_[slot.place]);
  }
  template <class Object>
  Owned<Object> own(Object* object, Slot<void(Object*)> release) const {
    return Owned<Object>(object, {(*this)[release]});
  }

  /// The message of a failed call; empty if it succeeded. Releases the status.
  std::string failure(Status* status) const;

 private:
  explicit Api(Table* table) : table_(table) {}
  Table* table_;
};

}  // namespace weft::inference::ort
