// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kit/testing/contract_subject.hpp"

/// Hosts that are unlike this one, and inputs that lie unlike this host's: the answers must be the
/// same.
namespace weft::conformance {

/// Gives calls a separate host table that forwards their requests.
class OtherHost : public testing::Passage {
 public:
  std::int32_t prepare(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override;
  std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override;

 protected:
  /// The memory that alloc gives a component for "SLOT/ARRAY"; `memory` is the host's.
  virtual void* given(void* memory, const std::string& /*name*/, std::int64_t /*bytes*/) {
    return memory;
  }
  /// Receives each text that the component logs, from any thread.
  virtual void logged(const char* /*text*/) {}
  /// Receives the result of each invocation of another component.
  virtual void invoked(std::uint64_t /*component*/, std::int32_t /*status*/,
                       const weft_error& /*error*/) {}
  /// Receives the status that the component returned from prepare or process.
  virtual void left(std::int32_t /*status*/) {}
  /// A call that stands for `call`, with the host table `host`; both live as long as this.
  virtual const weft_call& dressed(const weft_call& call, const weft_host& host);

 private:
  struct Stay;
  friend struct Forward;
  std::unique_ptr<weft_call> call_;
  std::unique_ptr<weft_host> host_;
};

/// Counts allocations, and refuses the one with number `refused`.
class StingyHost final : public OtherHost {
 public:
  explicit StingyHost(int refused) : refused_(refused) {}
  bool has_refused() const { return asked_ > refused_; }
  /// The component's own status of the call in which it was refused.
  std::int32_t answer() const { return answer_.value_or(WEFT_OK); }

 protected:
  void* given(void* memory, const std::string& name, std::int64_t bytes) override;
  void left(std::int32_t status) override;

 private:
  int refused_, asked_ = 0;
  std::optional<std::int32_t> answer_;
};

/// Memory from alloc ends at guard bytes that must not change.
class WalledHost final : public OtherHost {
 public:
  /// "SLOT/ARRAY" of the first that was written beyond; empty for none.
  const std::string& breached() const { return breached_; }

 protected:
  void* given(void* memory, const std::string& name, std::int64_t bytes) override;
  void left(std::int32_t status) override;

 private:
  struct Room {
    void* of_host;
    std::size_t bytes;              ///< [bytes] requested size
    std::vector<std::byte> memory;  ///< with guard bytes behind the requested size
    std::byte* begin;
  };
  std::map<std::string, Room> rooms_;  ///< allocations of the current call
  std::string breached_;
};

/// Memory from alloc is filled with these bytes.
class DirtyHost final : public OtherHost {
 public:
  explicit DirtyHost(unsigned char dirt) : dirt_(dirt) {}

 protected:
  void* given(void* memory, const std::string& name, std::int64_t bytes) override;

 private:
  unsigned char dirt_;
};

/// Some bytes behind which nothing can be read.
class EndOfPage {
 public:
  explicit EndOfPage(std::size_t bytes);
  ~EndOfPage();
  EndOfPage(const EndOfPage&) = delete;
  EndOfPage& operator=(const EndOfPage&) = delete;
  template <class T>
  T* at() const {
    return static_cast<T*>(data_);
  }

 private:
  void* mapped_;
  void* data_;
};

/// The first host of this major version: its structs end at their original size, and a component
/// that reads beyond them faults.
class OldHost final : public OtherHost {
 public:
  std::int32_t create(const weft_component& component, const weft_create& with, void** self,
                      weft_error* error) override;
  std::int32_t prepare(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override;
  std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override;

 protected:
  const weft_call& dressed(const weft_call& call, const weft_host& host) override;

 private:
  std::vector<std::unique_ptr<EndOfPage>> pages_;
};

/// A host of a later version: its structs have grown by unknown fields.
class NewHost final : public OtherHost {
 public:
  std::int32_t create(const weft_component& component, const weft_create& with, void** self,
                      weft_error* error) override;
  std::int32_t prepare(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override;
  std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override;

 protected:
  const weft_call& dressed(const weft_call& call, const weft_host& host) override;

 private:
  std::vector<std::vector<std::uint64_t>> grown_;
};

/// How the arrays of an input lie; all of these are legal.
enum class Lie {
  padded,     ///< rows with something between them
  backwards,  ///< the last row first
  aligned,    ///< to their elements alone
};

/// Gives inputs that lie so.
class LaidOut final : public testing::Passage {
 public:
  explicit LaidOut(Lie lie) : lie_(lie) {}
  std::int32_t prepare(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override;
  std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override;

 private:
  Lie lie_;
};

/// Gives inputs that are unknown to the component: arrays in its records, and whole records.
class Unknown final : public testing::Passage {
 public:
  enum class What { arrays, slots };
  explicit Unknown(What what) : what_(what) {}
  std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override;

 private:
  What what_;
};

}  // namespace weft::conformance
