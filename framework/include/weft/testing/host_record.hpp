// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <weft/data/codec.hpp>

namespace weft::host {
class Record;
}

namespace weft::testing {

/// A record in the host's memory.
using HostRecord = std::shared_ptr<const host::Record>;

/// Builds a record array by array.
class RecordMaker {
 public:
  explicit RecordMaker(const char* type);

  /// Allocates an array in C order, not cleared; null if the request is illegal.
  void* operator()(const char* name, std::int32_t dtype, int ndim, const std::int64_t* shape);

  void set_revision(std::uint64_t revision);
  void set_producer(std::uint64_t handle);
  HostRecord finish() { return std::move(record_); }

 private:
  std::shared_ptr<host::Record> record_;
};

/// Copies a record struct; null if it is not a legal record.
template <class RecordType>
HostRecord hold(const RecordType& typed) {
  RecordMaker maker(RecordType::kType);
  if (!write_record(typed, maker)) return nullptr;
  if constexpr (requires { typed.revision; }) maker.set_revision(typed.revision);
  if constexpr (requires { typed.producer_handle; }) maker.set_producer(typed.producer_handle);
  return maker.finish();
}

/// Fetches all arrays of a record from the device; null for a record of another type.
HostRecord fetched(const HostRecord& record, std::string_view type);

/// The arrays in the form of the contract, valid while the record lives.
weft_record view_of(const HostRecord& record);

/// The struct of a record, which borrows from it; nothing for a record of another type.
template <class RecordType>
std::optional<RecordType> typed_in(const HostRecord& record) {
  const HostRecord here = fetched(record, RecordType::kType);
  if (here == nullptr) return std::nullopt;
  auto typed = read_record<RecordType>(view_of(here));
  if (!typed) return std::nullopt;
  return *std::move(typed);
}

}  // namespace weft::testing
