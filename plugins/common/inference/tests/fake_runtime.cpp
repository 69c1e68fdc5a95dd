// SPDX-License-Identifier: Apache-2.0
// A library with the entry of ONNX Runtime. It offers no table of functions, or one whose every
// call fails if the environment variable WEFT_FAKE_TABLE is set.
#include <cstdint>
#include <cstdlib>

namespace {

using Entry = void (*)();

const char* message(const void* /*status*/) { return "this library\nruns nothing"; }
void* failing() {
  static char status = 0;
  return &status;
}
void release(void* /*status*/) {}

Entry* table_of(std::uint32_t /*version*/) {
  static Entry table[160];
  if (std::getenv("WEFT_FAKE_TABLE") == nullptr) return nullptr;
  for (Entry& entry : table) entry = reinterpret_cast<Entry>(failing);
  table[2] = reinterpret_cast<Entry>(message);
  table[93] = reinterpret_cast<Entry>(release);
  return table;
}
const char* version() { return "0.4.2"; }

struct Base {
  Entry* (*table_of)(std::uint32_t);
  const char* (*version)();
};

}  // namespace

extern "C" __attribute__((visibility("default"))) const Base* OrtGetApiBase() {
  static const Base base{table_of, version};
  return &base;
}
