// SPDX-License-Identifier: Apache-2.0
#include <weft/testing/host_record.hpp>

#include "host/records/record.hpp"

namespace weft::testing {

RecordMaker::RecordMaker(const char* type) : record_(host::Record::make(type)) {}

void* RecordMaker::operator()(const char* name, std::int32_t dtype, int ndim,
                              const std::int64_t* shape) {
  return record_->allocate(name, dtype, ndim, shape);
}

void RecordMaker::set_revision(std::uint64_t revision) { record_->set_revision(revision); }

void RecordMaker::set_producer(std::uint64_t handle) { record_->set_producer(handle); }

HostRecord fetched(const HostRecord& record, std::string_view type) {
  if (record->type() != type) return nullptr;
  const auto here = record->in_host_memory();
  return here ? *here : nullptr;
}

weft_record view_of(const HostRecord& record) { return record->view(""); }

}  // namespace weft::testing
